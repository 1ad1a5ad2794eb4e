#pragma once
/// A fitted parameter in the JSON of a calibration and of a diagnosis. Private to the module.

#include "fields.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

/// `whole`: with its bounds and what a calibration alone says.
template <class Fields>
void describe_parameter(Fields& f, calibration::FittedParameter& p, bool whole) {
  f("paths", p.paths);
  f("unit", p.unit);
  f("start", p.start);
  f.optional("nominal_range", p.stated);
  if (whole) f.pair("bounds", p.lower, p.upper);
  f("value", p.value);
  f("deviation", p.deviation);
  f.pair("interval_95", p.interval_low, p.interval_high);
  if (whole) {
    f("deviation_data_alone", p.data_deviation);
    f("other_value", p.other_value);
  } else {
    f.derived("at_bound", p.verdict == calibration::Verdict::at_bound);
  }
  f.word("verdict", p.verdict, words_of<calibration::Verdict, 5>(verdict_word));
}

}  // namespace hydrapod::report
