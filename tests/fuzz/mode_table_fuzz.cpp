/// Any bytes as the table of modes of `hydrapod identify`, bare or behind its first titles, as the
/// first byte says.

#include "fuzz.hpp"
#include "hydrapod/report/measured_results.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydrapod;
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  const std::string titles =
      "mode,frequency_hz,frequency_95_hz,damping_ratio,damping_95,significance,";
  fuzz::accepted([&] {
    const std::string& path = fuzz::file_of(data[0] % 2 == 0 ? text : titles + text);
    if (!report::is_identified_modes_csv(path)) return;
    const auto list = report::identified_modes_from_csv(path);
    for (const auto& mode : list.modes.modes)
      if (mode.shape.size() != static_cast<Eigen::Index>(list.modes.outputs.size())) std::abort();
  });
  return 0;
}
