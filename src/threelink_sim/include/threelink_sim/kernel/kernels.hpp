/// @file
/// The kernels: the inner loops of the simulation, compiled for several instruction sets. The
/// widest one that the processor supports is chosen at run time.
///
/// Every kernel works on n swimmers at once in a structure of arrays: quantity q of swimmer i
/// is q[i], and that of hinge j is q[j * stride + i]. n = 1 is the single swimmer: scalar and batch
/// are the same code and agree to the bit, as do avx2 and avx512. The baseline has no fused
/// multiply-add, and its last bits may differ.
#pragma once

#include <cstddef>
#include <cstdint>

namespace threelink_sim {

enum class Isa;  ///< isa.hpp; not included, since kernel files use nothing of the standard library

/// The parameters of the swimmer for the kernels; threelink_sim::Model is the validated form.
struct KernelModel {
  int links;           ///< N
  double gamma;        ///< C_parallel / C_perp
  double joint_limit;  ///< [rad] |alpha_j| <= joint_limit
};

/// One action step: constant rates for dt, reduced at the joint limit.
struct AdvanceArgs {
  KernelModel model;
  double dt;             ///< [T0]
  int substeps;          ///< Gauss steps within dt
  std::size_t n;         ///< swimmers
  std::size_t stride;    ///< between the hinges' blocks
  double* x;             ///< [L] (n) centroid, in and out
  double* y;             ///< [L] (n)
  double* heading;       ///< [rad] (n) angle of the heading link, in and out
  double* alpha;         ///< [rad] (N-1, n) hinge angles, in and out
  double* rates;         ///< [1/T0] (N-1, n) in: wanted, out: applied after the joint limit
  double* displacement;  ///< [L] (2, n) out: of the centroid, x block then y block
  double* work;          ///< [C_perp L^3/T0] (n) out: done on the fluid
};

/// Body velocity and power in a given shape, body frame: origin centroid, x along the heading link.
struct MotionArgs {
  KernelModel model;
  std::size_t n;
  std::size_t stride;
  const double* alpha;  ///< [rad] (N-1, n)
  const double* rates;  ///< [1/T0] (N-1, n)
  double* velocity;     ///< [L/T0] (2, n) out: of the centroid, body frame
  double* spin;         ///< [1/T0] (n) out: turning rate of the heading link
  double* power;        ///< [C_perp L^3/T0^2] (n) out
};

/// The kernels of one instruction set.
struct Kernels {
  const char* isa;  ///< "baseline", "avx2" or "avx512"
  bool fused;       ///< fused multiply-add: bits agree with every other fused kernel
  void (*advance)(const AdvanceArgs&);
  void (*motion)(const MotionArgs&);
  /// sine[i], cosine[i] of angle[i], i < n; one of the results may overwrite the angles
  void (*sincos)(std::size_t n, const double* angle, double* sine, double* cosine);
  /// Of distances r [L] in (0, 30): weight[i] = tanh(r[i] / 0.1), log[i] = (ln r[i] + 4) / 2, i < n
  void (*distance)(std::size_t n, const double* r, double* weight, double* log);
  /// Philox4x32-10: four random words for each counter of four words; see random.hpp for the
  /// layout.
  void (*philox)(std::size_t n, const std::uint32_t key[2], const std::uint32_t* counters,
                 std::uint32_t* words);
  /// Two standard normals for each counter: out[2 i], out[2 i + 1].
  void (*normals)(std::size_t n, const std::uint32_t key[2], const std::uint32_t* counters,
                  double* out);
};

/// The kernels of an instruction set. Throws std::invalid_argument if this processor lacks it.
const Kernels& kernels(Isa isa);

/// The kernels in use; see isa_in_use().
const Kernels& kernels();

}  // namespace threelink_sim
