/// Ten thousand damaged records and two thousand hostile texts given to the program: it ends by
/// itself, soon, with little memory, and where a record carries a checksum no changed value goes
/// unsaid. Prints the tables of docs/validation/damaged-records.md, section "At random".

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>

#include "faults.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using data::RecordFormat;
using test::Random;

constexpr double most_seconds = 5.0, most_mib = 300.0;

std::size_t below(Random& random, std::size_t count) {
  return std::min(count - 1,
                  static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}

/// What the runs of one row came to.
struct Row {
  int files{}, refused{}, said{}, unchanged{}, unsaid{}, killed{};
  double slowest{}, most_memory{};  ///< [s] of the processor; [MiB] beside the file

  /// One command that reads `path`; the exit code is one of the program's own.
  void judge(const test::RunResult& run, const std::string& path, const std::string& which) {
    const double size = std::ldexp(static_cast<double>(std::filesystem::file_size(path)), -20);
    slowest = std::max(slowest, run.processor_seconds);
    most_memory = std::max(most_memory, run.peak_mib - size);
    if (run.timed_out || run.exit_code > 2) ++killed;
    EXPECT_FALSE(run.timed_out) << which;
    EXPECT_LE(run.exit_code, 2) << which << '\n' << run.err;
    EXPECT_LT(run.processor_seconds, most_seconds) << which;
    EXPECT_LT(run.peak_mib - size, most_mib) << which;
    EXPECT_EQ(base::first_invalid_utf8(run.err), std::string::npos) << which;
    if (run.exit_code != 0) EXPECT_FALSE(run.err.empty()) << which;
  }
};

// Records

/// One to three damages of the kinds that disks, transfers and editors make.
std::string damaged(std::string bytes, Random& random) {
  const auto place = [&] { return below(random, bytes.size()); };
  const auto any = [&] { return static_cast<char>(below(random, 256)); };
  for (std::size_t left = 1 + below(random, 3); left > 0 && bytes.size() > 1; --left) {
    const std::size_t at = place(), length = std::min(1 + below(random, 600), bytes.size() - at);
    switch (below(random, 8)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        bytes[at] = any();
        break;
      case 2:  // a word, often a size
        for (std::size_t k = at; k < std::min(at + 4, bytes.size()); ++k)
          bytes[k] = random.chance(0.5) ? static_cast<char>(-1) : any();
        break;
      case 3:
        bytes.resize(at + 1);
        break;
      case 4:
        bytes.erase(at, length);
        break;
      case 5:
        bytes.insert(at, bytes.substr(place(), length));
        break;
      case 6:
        bytes.replace(at, length, std::string(length, '\0'));
        break;
      default: {
        const std::string other = bytes.substr(place(), length);
        bytes.replace(at, std::min(other.size(), length), other.substr(0, length));
      }
    }
  }
  return bytes;
}

data::Record ugly_record() {
  data::Record record;
  record.header.title = "seven channels";
  record.header.sample_rate = 317.25;
  record.header.start = -1.75;
  record.header.notes = "a line\nand another, with µ";
  const char* units[] = {"m", "m/s^2", "N", "Pa", "A", "rad", "1"};
  for (int c = 0; c < 7; ++c)
    record.header.channels.push_back({.name = fmt::format("channel {} of 7", c + 1),
                                      .unit = units[c],
                                      .direction = static_cast<data::Direction>(c - 3),
                                      .role = c < 3 ? data::Role::excitation : data::Role::response,
                                      .point = 3 * c});
  record.samples = data::Samples::NullaryExpr(211, 7, [](Eigen::Index k, Eigen::Index c) {
    return std::sin(0.61 * static_cast<double>(k * k % 89) + 1.3 * static_cast<double>(c));
  });
  return record;
}

struct Found {
  data::Record record{};
  bool notes{};
  bool damage{};  ///< one of the notes is about damage
  data::ChecksumFinding checksum{};
};

/// Not just any: a unit that is not known says nothing of a sample that was changed.
bool tells_of_damage(const base::Diagnostic& note) {
  return std::ranges::any_of(
      std::array{"checksum", "cut off", "damaged", "not completed"},
      [&](const char* word) { return note.message.find(word) != std::string::npos; });
}

Found found(const std::string& path) {
  data::RecordSet set({path}, {.sample_rate = 317.25});
  Found all{.record = {.header = set.header(), .samples = {}}};
  std::vector<double> numbers;
  set.stream([&](std::size_t /*file*/, const auto& block) {
    for (Eigen::Index k = 0; k < block.rows(); ++k)
      for (Eigen::Index c = 0; c < block.cols(); ++c) numbers.push_back(block(k, c));
    return numbers.size() < 10'000'000;
  });
  const auto columns = static_cast<Eigen::Index>(all.record.header.channels.size());
  all.record.samples = Eigen::Map<const data::Samples>(
      numbers.data(), static_cast<Eigen::Index>(numbers.size()) / columns, columns);
  const auto notes = set.notes();
  all.notes = !notes.empty();
  all.damage = std::ranges::any_of(notes, tells_of_damage);
  all.checksum = set.checksum();
  return all;
}

/// What a calculation would use.
bool same(const data::Record& a, const data::Record& b) {
  const auto& x = a.header;
  const auto& y = b.header;
  if (x.channels.size() != y.channels.size() || x.sample_rate != y.sample_rate ||
      x.start != y.start || a.samples.rows() != b.samples.rows())
    return false;
  for (std::size_t k = 0; k < x.channels.size(); ++k)
    if (x.channels[k].name != y.channels[k].name || x.channels[k].unit != y.channels[k].unit ||
        x.channels[k].direction != y.channels[k].direction ||
        x.channels[k].role != y.channels[k].role)
      return false;
  return a.samples == b.samples;
}

TEST(HostileFilesLong, DamagedRecordsAreSaid) {
  using enum RecordFormat;
  const test::TemporaryFolder folder;
  const std::string path = (folder / "r").string();
  std::printf(
      "| format | files | refused | read, damage said | read, same numbers | other numbers, "
      "not said | killed | slowest [s] | memory [MiB] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  constexpr int files = 1250;
  int total = 0;
  for (const RecordFormat format : {hdf5, mat73, mat5, csv, uff, uff_ascii, rpc, rpc_short}) {
    data::write_record(path, ugly_record(), format);
    const std::string whole = test::read_text(path);
    const Found truth = found(path);
    const bool carries_checksum = truth.checksum == data::ChecksumFinding::holds;
    const std::string name{data::format_text(format)};
    Row row;
    for (int seed = 1; seed <= files; ++seed) {
      Random random(static_cast<std::uint64_t>(seed) * 1009 + static_cast<std::uint64_t>(format));
      test::write_text(path, damaged(whole, random));
      const std::string which = fmt::format("{}, seed {}", name, seed);
      ++row.files;
      row.judge(test::run_hydrapod({"record", "verify", "--rate", "317.25", path}), path, which);
      try {
        const Found now = found(path);
        const bool changed = !same(now.record, truth.record);
        const bool differs = now.checksum == data::ChecksumFinding::differs,
                   said = carries_checksum ? differs || now.damage : now.notes;
        ++(said ? row.said : changed ? row.unsaid : row.unchanged);
        EXPECT_FALSE(carries_checksum && changed && !said) << which;
      } catch (const base::InputError&) {
        ++row.refused;
      }
    }
    std::printf("| %s%s | %d | %d | %d | %d | %d | %d | %.2f | %.0f |\n", name.c_str(),
                carries_checksum ? "" : ", no checksum", row.files, row.refused, row.said,
                row.unchanged, row.unsaid, row.killed, row.slowest, row.most_memory);
    std::fflush(stdout);
    total += row.files;
  }
  EXPECT_EQ(total, 10'000);
}

// Texts

std::string hostile_token(Random& random) {
  static const std::vector<std::string> tokens{"nan",
                                               "-nan",
                                               "inf",
                                               "1e999",
                                               "-1e308",
                                               "1e-320",
                                               "0",
                                               "-0.0",
                                               "-1",
                                               "1e15",
                                               "99999999999999999999999",
                                               "0x1p1023",
                                               "1.7976931348623157e308",
                                               "9007199254740993",
                                               "\"\"",
                                               "\"1e5 m\"",
                                               "\"5 furlong\"",
                                               "\"\\u0000\"",
                                               "null",
                                               "true",
                                               "{}",
                                               "[]",
                                               "[[0]]",
                                               "\xff\xfe",
                                               "\xc3\x28",
                                               std::string(1, '\0'),
                                               "\xef\xbb\xbf",
                                               "\r",
                                               "\t",
                                               "'''",
                                               "#",
                                               "\\",
                                               std::string(3000, '['),
                                               std::string(3000, '{'),
                                               std::string(70'000, '9'),
                                               std::string(20'000, 'x'),
                                               "..",
                                               "../../../etc/passwd",
                                               "/dev/zero",
                                               "%s%n",
                                               "${HOME}"};
  return tokens[below(random, tokens.size())];
}

/// One to three changes to what an editor would call words and lines.
std::string hostile(std::string text, Random& random) {
  for (std::size_t left = 1 + below(random, 3); left > 0 && !text.empty(); --left) {
    const std::size_t at = below(random, text.size());
    const auto is_word = [&](std::size_t k) {
      return std::isalnum(static_cast<unsigned char>(text[k])) != 0 || text[k] == '.' ||
             text[k] == '-' || text[k] == '+' || text[k] == '_';
    };
    std::size_t begin = at, end = at;
    while (begin > 0 && is_word(begin - 1)) --begin;
    while (end < text.size() && is_word(end)) ++end;
    const std::size_t line =
        text.rfind('\n', at) == std::string::npos ? 0 : text.rfind('\n', at) + 1;
    const std::size_t next = std::min(text.find('\n', at), text.size() - 1) + 1;
    switch (below(random, 8)) {
      case 0:
      case 1:
      case 2:
        text.replace(begin, std::max<std::size_t>(end - begin, 1), hostile_token(random));
        break;
      case 3:
        text.insert(at, hostile_token(random));
        break;
      case 4:
        text.erase(line, next - line);
        break;
      case 5:
        text.insert(line, text.substr(line, next - line));
        break;
      case 6:
        text.resize(at);
        break;
      default:
        text.erase(begin, std::max<std::size_t>(end - begin, 1));
    }
  }
  return text;
}

struct TextKind {
  std::string name, file;
  std::vector<std::string> make;                ///< the command that writes it; empty: a copy
  std::vector<std::vector<std::string>> reads;  ///< commands that read it
};

/// Files that are sound, and what reads them.
std::vector<TextKind> text_kinds(const test::TemporaryFolder& folder) {
  const std::string machine = "m.toml";
  test::write_text(folder / machine,
                   test::read_text(test::source_file("models/heavy-platform.toml")));
  test::write_text(folder / "motion.csv",
                   "time [s], x [mm], rz [deg]\n0,0,0\n0.1,1.5,0.2\n0.25,3.25,-0.1\n0.4,-1,0\n");
  test::write_text(folder / "h.csv",
                   "frequency,direction,deviation\n7.31 Hz,x,1 %\n7.44 Hz,y,1 %\n11.2 Hz,z,2 %\n");
  data::write_record(folder / "r.csv", test::force_and_motion(900), RecordFormat::csv);
  return {
      {"machine file", "h.toml", {"init", "h.toml"}, {{"check", "h.toml"}, {"modes", "h.toml"}}},
      {"modes of a machine, JSON",
       "h.json",
       {"modes", machine, "-o", "h.json"},
       {{"calibrate", machine, "--targets", "h.json", "--free", "platform.mass"}}},
      {"targets, CSV",
       "h.csv",
       {},
       {{"calibrate", machine, "--targets", "h.csv", "--free", "platform.mass"}}},
      {"trajectory, CSV",
       "motion.csv",
       {},
       {{"simulate", machine, "--command", "file motion.csv", "--until", "0.01", "--model", "rigid",
         "-o", "s.csv", "--force"}}},
      {"record, CSV", "r.csv", {}, {{"record", "show", "r.csv"}, {"identify", "r.csv"}}},
  };
}

/// "nan" is none in "resonance".
bool has_word(const std::string& text, const std::string& word) {
  const auto letter = [&](std::size_t at) {
    return at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) != 0;
  };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1))
    if (!letter(at - 1) && !letter(at + word.size())) return true;
  return false;
}

TEST(HostileFiles, ANumberThatIsNoneIsAWordOfItsOwn) {
  for (const char* text : {"nan", "f = nan Hz", "[-nan]", "1,nan\n"})
    EXPECT_TRUE(has_word(text, "nan")) << text;
  for (const char* text : {"resonance", "nano", "Hannan", ""})
    EXPECT_FALSE(has_word(text, "nan")) << text;
}

/// 400 hostile variants of one kind, read by all that reads it.
Row read_hostile(const TextKind& kind, const test::TemporaryFolder& folder, std::size_t number) {
  const test::RunOptions here{.folder = folder.path()};
  if (!kind.make.empty()) {
    const auto made = test::run_hydrapod(kind.make, here);
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }
  const std::string path = (folder / kind.file).string(), whole = test::read_text(path);
  Row row;
  for (int seed = 1; seed <= 400; ++seed) {
    Random random(static_cast<std::uint64_t>(seed) * 2003 + number);
    test::write_text(path, hostile(whole, random));
    ++row.files;
    bool read = true;
    for (const auto& command : kind.reads) {
      const auto run = test::run_hydrapod(command, here);
      row.judge(run, path, fmt::format("{}, seed {}, {}", kind.name, seed, command.front()));
      EXPECT_FALSE(has_word(run.out, "nan")) << kind.name << ", seed " << seed;
      read = read && run.exit_code == 0;
    }
    ++(read ? row.unchanged : row.refused);
  }
  return row;
}

TEST(HostileFilesLong, HostileTextsEndWithAMessage) {
  const test::TemporaryFolder folder;
  const auto kinds = text_kinds(folder);
  std::printf(
      "| text | files | refused | read | killed | slowest [s] | memory [MiB] |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  int total = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const Row row = read_hostile(kinds[k], folder, k);
    std::printf("| %s | %d | %d | %d | %d | %.2f | %.0f |\n", kinds[k].name.c_str(), row.files,
                row.refused, row.unchanged, row.killed, row.slowest, row.most_memory);
    std::fflush(stdout);
    total += row.files;
  }
  EXPECT_EQ(total, 2000);
}

}  // namespace
}  // namespace hydrapod
