/// Any text as --command and --excite, line by line: an InputError, or signals that can be sampled
/// and whose text says the same again.
///
/// The first byte selects what is read. Trajectories in files have a target of their own.

#include <vector>

#include "fuzz.hpp"
#include "hydrapod/signals/signals.hpp"

namespace {

using namespace hydrapod;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::string& line : base::split(text, "\n"))
    if (lines.size() < 6 && base::trimmed(line).find("file") == std::string_view::npos)
      lines.push_back(std::move(line));
  return lines;
}

void read_as_signals(const std::string& text, bool excitation) {
  const signals::TextPlace place{
      .argument = excitation ? "--excite" : "--command",
      .units = excitation ? signals::drive_units : signals::displacement_units,
      .rate = 1000.0,
      .excitation = excitation};
  for (const auto& signal : signals::read_signals(lines_of(text), place)) {
    signals::require_sound(signal, place.rate);
    signals::natural_duration({signal});
    signals::period_samples({signal}, place.rate);
    const std::string written = signals::signal_text(signal, place.units);
    const auto again = signals::read_signals({written}, place);
    if (again.size() != 1 || signals::signal_text(again.front(), place.units) != written)
      std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] { read_as_signals(text, data[0] % 2 == 1); });
  return 0;
}
