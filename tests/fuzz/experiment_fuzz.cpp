/// Any bytes as what a record says of its experiment: in JSON, in the notes of older records, and
/// in the comments at the head of a record of text. What was read is written and read again alike.

#include <stdexcept>

#include "fuzz.hpp"
#include "hydrapod/data/record.hpp"
#include "record_fuzz.hpp"

namespace {

using namespace hydrapod;

void read_experiment(const std::string& json, const std::string& notes) {
  data::Experiment experiment;
  try {
    experiment = data::read_experiment(json, notes);
  } catch (const std::invalid_argument&) {
    return;
  }
  std::string written;
  try {
    written = data::experiment_json(experiment);
  } catch (const std::invalid_argument&) {  // notes that are not UTF-8
    if (!json.empty()) std::abort();
    return;
  }
  if (written.empty()) return;
  const auto again = data::read_experiment(written, "");
  if (data::experiment_json(again) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  switch (data[0] % 3) {
    case 0:
      read_experiment(text, "");
      break;
    case 1:
      read_experiment("", "test rig of hydrapod\n" + text);
      break;
    default:
      fuzz::read_as_record("# hydrapod record 1\n# sample_rate_hz: 2000\n" + text +
                           "\n# channel: a,m,x,response,0\na [m]\n1\n");
  }
  return 0;
}
