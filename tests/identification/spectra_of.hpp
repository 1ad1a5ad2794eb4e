#pragma once
/// Cross spectra of a whole record.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

inline CrossSpectra spectra_of(const data::Record& record, const SpectrumOptions& options) {
  SpectrumEstimator estimator(record.header, options);
  estimator.add(record.samples);
  return estimator.result();
}

}  // namespace hydrapod::identification
