/// Writers that end in the middle: killed, or on a disk that is full after any number of bytes.
/// What was there before stays; the part can be read as far as it was written.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;
namespace fs = std::filesystem;

constexpr Eigen::Index channels = 7, rows_of_block = 511;

data::Record record(Eigen::Index samples) {
  data::Record all;
  for (int c = 0; c < channels; ++c)
    all.header.channels.push_back(
        {fmt::format("sensor {}", c), "m", data::Direction::x, data::Role::response, c});
  all.header.sample_rate = 1000.0;
  all.header.notes = std::string(3000, 'n') + "\nsecond line";
  all.samples = data::Samples::NullaryExpr(samples, channels, [](Eigen::Index k, Eigen::Index c) {
    return std::cos(0.01 * static_cast<double>(k * (c + 1)));
  });
  return all;
}

void append_all(data::RecordWriter& writer, const data::Samples& samples) {
  for (Eigen::Index at = 0; at < samples.rows(); at += rows_of_block)
    writer.append(samples.middleRows(at, std::min(rows_of_block, samples.rows() - at)));
}

/// Reads the first samples of `whole`, to what a complete file of the format keeps; how many.
Eigen::Index readable_rows(const fs::path& part, const data::Record& whole, RecordFormat format,
                           bool complete = false) {
  const auto read = data::read_record(part.string()).record;
  EXPECT_EQ(read.header.notes, whole.header.notes);
  EXPECT_EQ(read.header.channels.size(), whole.header.channels.size());
  EXPECT_LE(read.samples.rows(), whole.samples.rows());
  const double tolerance = format == RecordFormat::rpc                     ? 6e-8
                           : complete && format == RecordFormat::rpc_short ? 1.6e-5
                           : complete && format == RecordFormat::uff_ascii ? 1e-12
                                                                           : 0.0;
  const auto difference = read.samples - whole.samples.topRows(read.samples.rows());
  EXPECT_LE(read.samples.rows() == 0 ? 0.0 : difference.cwiseAbs().maxCoeff(), tolerance);
  return read.samples.rows();
}

class InterruptedWriter : public testing::TestWithParam<RecordFormat> {
 protected:
  InterruptedWriter() { write_text(path, "what was there before"); }
  void TearDown() override { EXPECT_EQ(read_text(path), "what was there before"); }
  TemporaryFolder folder;
  fs::path path = folder / "r", part = folder / "r.part";
};

/// Its end is that of a process that is killed: nothing is closed, no destructor runs.
TEST_P(InterruptedWriter, KilledLosesAMegabyteAtMost) {
  const auto whole = record(47'311);  // 2.6 MB
  const pid_t child = ::fork();
  if (child == 0) {
    const auto writer = data::open_record_writer(path.string(), whole.header, GetParam());
    append_all(*writer, whole.samples);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  const Eigen::Index lost = (1 << 20) / (8 * channels) + rows_of_block;
  EXPECT_GE(readable_rows(part, whole, GetParam()), whole.samples.rows() - lost);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
}

/// What happened to a writer for which files may have `bytes` at most.
struct Ending {
  std::string error{};
  bool complete{};
};
Ending write_with_limit(const fs::path& path, const data::Record& whole, RecordFormat format,
                        std::size_t bytes) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int code = 0;
    try {
      const auto writer = data::open_record_writer(path.string(), whole.header, format);
      append_all(*writer, whole.samples);
      writer->close(false);  // what is there stays
    } catch (const base::ComputationError& error) {
      code = std::string_view(error.what()).find("holds what was written before") ==
                     std::string_view::npos
                 ? 1
                 : 2;
    } catch (...) {
      code = 9;
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!WIFEXITED(status)) return {"killed"};
  return {WEXITSTATUS(status) == 1   ? "nothing kept"
          : WEXITSTATUS(status) == 2 ? "kept"
          : WEXITSTATUS(status) == 0 ? ""
                                     : "another error",
          WEXITSTATUS(status) == 0};
}

TEST_P(InterruptedWriter, OnADiskThatIsFullAfterAnyNumberOfBytesThePartIsLegible) {
  const auto whole = record(4'013);  // 225 kB
  bool ended = false;
  int kept = 0;
  for (std::size_t bytes = 1; !ended; bytes += 12'345) {
    const auto [error, complete] = write_with_limit(path, whole, GetParam(), bytes);
    if (complete) {
      ended = true;
      EXPECT_EQ(readable_rows(part, whole, GetParam(), true), whole.samples.rows());
    } else if (error == "kept") {
      ++kept;
      readable_rows(part, whole, GetParam());
    } else {
      EXPECT_EQ(error, "nothing kept") << bytes;
      EXPECT_FALSE(fs::exists(part)) << bytes;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), fs::exists(part) ? 2 : 1);
    fs::remove(part);
    ASSERT_LT(bytes, 3'000'000U);
  }
  // HDF5 and RPC III state their size once in a megabyte
  if (GetParam() != RecordFormat::hdf5 && GetParam() != RecordFormat::mat73 &&
      GetParam() != RecordFormat::rpc)
    EXPECT_GE(kept, 5);
}

/// What a killed run of a Universal File has left, with sizes that nothing can have.
TEST(SpooledPart, ThatIsDamagedIsRefused) {
  const TemporaryFolder folder;
  const auto part = [](std::uint64_t samples, std::uint64_t channels, std::uint64_t rows) {
    const std::string text = "# hydrapod record 1\n";
    const std::uint64_t counts[] = {samples, channels, rows, 4096};
    std::string bytes = "hydrapod spool 1\n";
    bytes.resize(24, '\0');
    bytes.append(reinterpret_cast<const char*>(counts), sizeof counts);
    bytes += text;
    bytes.resize(8192, '\0');
    return bytes;
  };
  for (const auto& bytes :
       {part(0, 0, 8192), part(1U << 20U, 0, 1), part(9, 1, 0), part(9, 3, 7)}) {
    write_text(folder / "r.uff.part", bytes);
    EXPECT_THROW(data::read_record((folder / "r.uff.part").string()), base::InputError);
  }
}

/// The place of the next file is taken by what another run has left.
TEST_P(InterruptedWriter, PartsOfEarlierRunsStay) {
  const auto whole = record(700);
  const auto keep = [](const fs::path& file) { write_text(file, "mine"); };
  for (const char* name : {"r.part", "r.part2.new", "r.part.new"}) keep(folder / name);
  const auto writer = data::open_record_writer(path.string(), whole.header, GetParam());
  append_all(*writer, whole.samples);
  EXPECT_EQ(writer->close(false), (folder / "r.part2").string());
  for (const char* name : {"r.part", "r.part2.new", "r.part.new"})
    EXPECT_EQ(read_text(folder / name), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 5);
}

INSTANTIATE_TEST_SUITE_P(Formats, InterruptedWriter,
                         testing::Values(RecordFormat::hdf5, RecordFormat::mat5,
                                         RecordFormat::mat73, RecordFormat::csv, RecordFormat::uff,
                                         RecordFormat::uff_ascii, RecordFormat::rpc,
                                         RecordFormat::rpc_short),
                         [](const auto& info) {
                           std::string name(data::format_text(info.param));
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace hydrapod::test
