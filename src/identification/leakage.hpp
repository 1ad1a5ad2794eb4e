#pragma once
/// The part of the noise that windows let in. Private to the module.

#include "hydrapod/identification/identify.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// Numbers of the tenth of the values that are largest, of 8 where there are few.
std::vector<std::size_t> largest_tenth(const VectorXd& values);

/// H errs by D g C⁻¹, see data::Leakage.
struct LeakageParts {
  std::vector<MatrixXcd> D{};  ///< R H' Q⁻¹ H'ᴴ = D Dᴴ per line, outputs × inputs
  MatrixXd share{};            ///< of leakage in the noise: lines × outputs, 0 to 1
};

/// Empty where leakage is not known, or where the noise is too small for it: the excitation is not
/// random. Noise is compared over `reach` lines on either side: at one line it is not known well.
LeakageParts leakage_parts(const FrequencyResponses& responses, const ModalModel& model,
                           const FitOptions& options);

}  // namespace hydrapod::identification
