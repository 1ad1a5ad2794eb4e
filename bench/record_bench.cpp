/// Writing and reading records, in bytes of samples per second, beside a copy of the file: 30
/// channels of 2^17 samples (31 MB), noise that does not compress.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "hydrapod/data/record_io.hpp"

namespace {

using namespace hydrapod;
namespace fs = std::filesystem;

constexpr int channels = 30, samples = 1 << 17;

const data::Record& record() {
  static const data::Record made = [] {
    data::Record r;
    r.header.sample_rate = 1000.0;
    for (int c = 0; c < channels; ++c)
      r.header.channels.push_back({.name = fmt::format("sensor {}", c + 1), .unit = "m/s^2"});
    std::mt19937_64 random(20261123);
    std::normal_distribution<double> normal;
    r.samples = data::Samples::NullaryExpr(samples, channels, [&] { return normal(random); });
    return r;
  }();
  return made;
}

/// A folder of its own for each run of the program.
const fs::path& folder() {
  struct Folder {
    fs::path path;
    Folder() {
      std::string name = (fs::temp_directory_path() / "record_bench.XXXXXX").string();
      path = ::mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
  };
  static const Folder made;
  return made.path;
}

std::string written(data::RecordFormat format) {
  const auto path = folder() / data::format_text(format);
  if (!fs::exists(path)) data::write_record(path, record(), format);
  return path;
}

void count(benchmark::State& state) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * channels * samples * 8);
}

void write(benchmark::State& state) {
  const auto format = static_cast<data::RecordFormat>(state.range(0));
  state.SetLabel(std::string(data::format_text(format)));
  for (auto _ : state) {
    state.PauseTiming();
    fs::remove(folder() / "new");
    state.ResumeTiming();
    data::write_record(folder() / "new", record(), format);
  }
  count(state);
}

void read(benchmark::State& state) {
  const auto format = static_cast<data::RecordFormat>(state.range(0));
  state.SetLabel(std::string(data::format_text(format)));
  const auto path = written(format);
  for (auto _ : state) {
    data::RecordSet set({path});
    double sum = 0.0;
    set.stream([&](std::size_t, const auto& block) {
      sum += block(0, 0);
      return true;
    });
    benchmark::DoNotOptimize(sum);
  }
  count(state);
}

/// The same samples as a plain copy of the HDF5 file.
void copy(benchmark::State& state) {
  const auto path = written(data::RecordFormat::hdf5);
  for (auto _ : state) fs::copy_file(path, folder() / "copy", fs::copy_options::overwrite_existing);
  count(state);
}

constexpr int formats = static_cast<int>(data::RecordFormat::rpc_short);

BENCHMARK(copy)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(write)->DenseRange(0, formats)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read)->DenseRange(0, formats)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
