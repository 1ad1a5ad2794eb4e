/// Exports of a machine, written to a folder of their own; `bytes`: what all files of one export
/// have together.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "models.hpp"

namespace {

using namespace hydrapod;

/// A new folder that is removed at the end.
struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "hydrapod-bench-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

void exported(benchmark::State& state, tasks::ExportFormat format, exchange::SystemKind system,
              bool measured) {
  const Folder folder;
  const auto machine = tasks::read_machine({.file = model_file("zhang-jiang-2021.toml")});
  const bool of_system = format <= tasks::ExportFormat::hdf5 || format >= tasks::ExportFormat::fmu2;
  tasks::ExportOptions options{
      .format = format, .path = (folder.path / "machine").string(), .approximate = true};
  options.measure = measured;
  if (of_system) options.system = system;
  std::uintmax_t bytes = 0;
  try {
    for (auto _ : state) benchmark::DoNotOptimize(tasks::export_machine(machine, options));
    for (const auto& file : tasks::export_files(format, options.path))
      bytes += std::filesystem::file_size(file);
  } catch (const base::InputError& error) {
    state.SkipWithError(error.what());
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

const int registered = [] {
  for (std::size_t k = 0; k < tasks::export_formats.size(); ++k) {
    const auto format = static_cast<tasks::ExportFormat>(k);
    const bool fmu = format >= tasks::ExportFormat::fmu2;
    benchmark::RegisterBenchmark(
        ("export/" + std::string(tasks::export_formats[k])).c_str(), &exported, format,
        fmu ? exchange::SystemKind::plant : exchange::SystemKind::mechanics, false)
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::RegisterBenchmark("export/mat_loop", &exported, tasks::ExportFormat::mat,
                               exchange::SystemKind::loop, false)
      ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("export/mat_measured", &exported, tasks::ExportFormat::mat,
                               exchange::SystemKind::mechanics, true)
      ->Unit(benchmark::kMicrosecond);
  return 0;
}();

}  // namespace
