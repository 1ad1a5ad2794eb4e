#pragma once
/// Outputs of a structure on which a machine stands whose speed is not constant: noise excites the
/// modes, and the machine makes vibrations at its speed and at multiples of it.

#include "output_only.hpp"

namespace hydrapod::test {

struct Machine {
  double frequency{};  ///< [Hz] of the speed, mean
  double spread{};     ///< standard deviation of the speed, relative
  double slow{0.05};   ///< [Hz] up to which the speed varies
  /// Of each multiple (1, 2, …) of the speed: amplitudes of outputs over their RMS, and phases.
  std::vector<Eigen::VectorXcd> orders{};
};

/// Added to what noise excites.
data::Record with_machine(data::Record record, const Machine& machine, std::uint64_t seed);

/// As a user identifies it: with --output-only.
identification::Identification identified_as_asked(const data::Record& record);

struct MachineClass {
  const char* name{};
  ModalSystem system{};
  OutputExperiment experiment{};
  Machine machine{};
};

/// Four unequal masses, 3.8, 8.7, 10.7 and 14.8 Hz, and a machine at 12.37 Hz with two multiples.
MachineClass floor_with_machine(double spread);

}  // namespace hydrapod::test
