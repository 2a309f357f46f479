/// @file
/// Proof that two machines compute the same bits.
#pragma once

#include <string>

namespace threelink_agent {

/// Of everything that workers and learner say to each other; to be raised with every change of it.
constexpr unsigned kProtocol = 2;

/// sha256 (64 hex digits) of what a few short episodes of built-in policies give in this process:
/// of three and of five links, towards a direction and to points, in batches and alone. It differs
/// where the bits of training episodes would: without fused multiply-adds, with another compiler's
/// mathematics, or with a version of this software that computes otherwise. Takes some
/// milliseconds.
std::string fingerprint();

}  // namespace threelink_agent
