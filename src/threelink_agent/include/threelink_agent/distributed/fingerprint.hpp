/// @file
/// A fingerprint that shows whether two machines compute the same bits.
#pragma once

#include <string>

namespace threelink_agent {

/// Version of the protocol between learner and workers; to be raised with every change of a
/// message.
constexpr unsigned kProtocol = 2;

/// sha256 (64 hex digits) of the results of a few short episodes of built-in policies in this
/// process: with three and five links, with a direction and with points as the goal, in batches and
/// alone. It differs if the bits of training episodes would differ: without fused multiply-adds,
/// with another compiler's mathematics, or with a version of this software that computes
/// differently. Takes some milliseconds.
std::string fingerprint();

}  // namespace threelink_agent
