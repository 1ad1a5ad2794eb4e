/// Any bytes as modes of a Universal File, bare or behind the beginning of a dataset 55, 2414 or
/// 2412, as the first byte says. Modes that were read are written as both datasets and read again.
/// As matrices, too.

#include "fuzz.hpp"
#include "hydrapod/data/modal_results.hpp"

namespace {

using namespace hydrapod;

void read_modes(const std::string& bytes) {
  static const fuzz::Folder folder;
  static const std::string again = folder.file("modes.uff");
  const auto read = data::read_modal_results(fuzz::file_of(bytes));
  for (const auto& note : read.notes) fuzz::require_presentable(note);
  const auto outputs = static_cast<Eigen::Index>(read.results.outputs.size());
  for (const auto& mode : read.results.modes)
    if (mode.shape.size() != outputs) std::abort();
  if (read.results.modes.empty()) return;
  for (const auto dataset : {data::ModalDataset::shapes, data::ModalDataset::analysis}) {
    data::write_modal_results(again, read.results, dataset);
    const auto second = data::read_modal_results(again).results;
    if (second.modes.size() != read.results.modes.size()) std::abort();
  }
}

/// What stands before the bytes. Even numbers stood for dataset 55 before there were others.
std::string beginning(std::uint8_t kind) {
  if (kind % 2 == 0) return "    -1\n    55\n";
  return kind % 8 == 3 ? "    -1\n  2414\n" : kind % 8 == 5 ? "    -1\n  2412\n" : "";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] { read_modes(beginning(data[0]) + text); });
  fuzz::accepted([&] {
    data::read_matrix_datasets(fuzz::file_of(data[0] % 2 == 0 ? "    -1\n   252\n" + text : text));
  });
  return 0;
}
