/// Any bytes as a study file, or as a distribution where the first byte is odd. What was accepted is
/// sound: every entry has its place, a distribution has finite quantiles that rise.

#include <cmath>

#include "fuzz.hpp"
#include "hydrapod/study/study.hpp"

namespace {

using namespace hydrapod;

void read_file(const std::string& text) {
  const auto study = study::read_study_file(fuzz::file_of(text));
  for (const auto* list : {&study.vary, &study.want})
    for (const auto& given : *list)
      if (given.place.empty()) std::abort();
  if (study.samples && *study.samples < 2) std::abort();
}

void read_distribution(const std::string& text) {
  const auto distribution = study::read_distribution(text, "N/m", 5.3e6, "fuzz");
  double before = -HUGE_VAL;
  for (const double p : {1e-6, 0.025, 0.31, 0.5, 0.87, 1.0 - 1e-6}) {
    const double value = study::quantile(distribution, p);
    if (!std::isfinite(value)) std::abort();
    if (distribution.shape != study::Shape::values && value < before) std::abort();
    before = value;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] { data[0] % 2 == 0 ? read_file(text) : read_distribution(text); });
  return 0;
}
