/// Damaged files: what each is told. docs/validation/damaged-records.md holds the table that this
/// test makes; it must be the same to the letter. HYDRAPOD_WRITE_TABLES=1 writes it anew.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;

/// Twenty samples of three channels.
data::Record record() {
  data::Record all;
  all.header.channels = {{"x", "m", data::Direction::x, data::Role::excitation, 1},
                         {"p", "Pa", data::Direction::leg1, data::Role::response, 2},
                         {"a", "m/s^2", data::Direction::z, data::Role::response, 3}};
  all.header.sample_rate = 100.0;
  all.samples = data::Samples::NullaryExpr(
      20, 3, [](Eigen::Index k, Eigen::Index c) { return std::cos(0.7 * k + c); });
  return all;
}

std::string written(RecordFormat format) {
  const TemporaryFolder folder;
  data::write_record(folder / "r", record(), format);
  return read_text(folder / "r");
}

struct Damage {
  const char* format;
  const char* what;
  std::string bytes;
};

std::string cut(std::string text, std::size_t size) {
  text.resize(size);
  return text;
}
std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::logic_error("nothing to damage: " + old);
  return text.replace(at, old.size(), by);
}
/// A Universal File as another program may write it: without hydrapod's dataset and words.
std::string of_another_program(std::string uff) {
  const std::size_t own = uff.find("    -1\n 99001");
  uff.erase(own, uff.find("    -1\n    58", own) - own);
  const auto everywhere = [&](const std::string& old, const std::string& by) {
    for (std::size_t at = 0; (at = uff.find(old, at)) != std::string::npos; at += by.size())
      uff.replace(at, old.size(), by);
  };
  everywhere("hydrapod", "recorder");
  everywhere(" of repeat ", " of session");
  return uff;
}
/// Up to and with the n-th occurrence of `mark`.
std::string until(const std::string& text, const std::string& mark, int n) {
  std::size_t at = 0;
  for (int i = 0; i < n; ++i) at = text.find(mark, at) + mark.size();
  return text.substr(0, at);
}
std::string with_word(std::string text, std::size_t at, std::uint32_t value) {
  std::memcpy(text.data() + at, &value, 4);
  return text;
}

/// With another bit in the number that is the last sample.
std::string with_changed_sample(std::string text) {
  const double sample = record().samples(19, 2);
  const std::size_t at =
      text.rfind(std::string(reinterpret_cast<const char*>(&sample), sizeof sample));
  if (at == std::string::npos) throw std::logic_error("the sample stands nowhere");
  text[at] = static_cast<char>(text[at] ^ 1);
  return text;
}

void add_csv(std::vector<Damage>& all) {
  const std::string csv = written(RecordFormat::csv);
  const std::string third = until(csv, "\n", 13);
  all.insert(all.end(),
             {{"CSV", "empty file", ""},
              {"CSV", "cut within the header", until(csv, "\n", 4)},
              {"CSV", "cut between two lines of samples", until(csv, "\n", 20)},
              {"CSV", "cut within a line of samples", cut(csv, csv.rfind("# checksum") - 15)},
              {"CSV", "another digit in a sample", replaced(csv, "0.7648", "0.7649")},
              {"CSV", "another unit", replaced(csv, "x,m,x", "x,N,x")},
              {"CSV", "a sample rate of zero", replaced(csv, "rate_hz: 100", "rate_hz: 0")},
              {"CSV", "a sample rate in words", replaced(csv, "rate_hz: 100", "rate_hz: fast")},
              {"CSV", "a negative sample rate", replaced(csv, "rate_hz: 100", "rate_hz: -100")},
              {"CSV", "repeat 0", replaced(csv, "repeat: 1", "repeat: 0")},
              {"CSV", "an unknown role", replaced(csv, "excitation,1", "exitation,1")},
              {"CSV", "an unknown direction", replaced(csv, "m,x,", "m,w,")},
              {"CSV", "a channel too few in the header",
               replaced(csv, "# channel: a,m/s^2,z,response,3\n", "")},
              {"CSV", "text where a number belongs", third + "0.04,1,zwei,3\n"},
              {"CSV", "a line with a field too few", third + "0.04,1,2\n0.05,1,2,3\n"},
              {"CSV", "a line with a field too many", third + "0.04,1,2,3,4\n"},
              {"CSV", "times that jump", third + "7.5,1,2,3\n"},
              {"CSV", "no column of times", "1;2\n3;4\n"},
              {"CSV", "times that stand still", "t,x\n1,2\n1,3\n1,4\n"},
              {"CSV", "text only", "Dear colleague,\nplease find attached\n"},
              {"any", "bytes of no format",
               std::string("\x7f"
                           "ELF\0\0\1\2",
                           8)}});
}

void add_uff(std::vector<Damage>& all) {
  const std::string uff = written(RecordFormat::uff_ascii);
  const std::string plain = of_another_program(uff);
  all.insert(
      all.end(),
      {{"UFF", "one delimiter only", "    -1\n"},
       {"UFF", "cut behind the file header", until(uff, "    -1\n", 2)},
       {"UFF", "cut within the header of the last function", cut(plain, plain.rfind("        17"))},
       {"UFF", "cut within the last function's values", cut(plain, plain.size() - 120)},
       {"UFF", "the last delimiter is missing", cut(plain, plain.size() - 7)},
       {"UFF", "more values declared than there are",
        replaced(plain, "        20         1", "     99999         1")},
       {"UFF", "fewer values declared than there are",
        replaced(plain, "        20         1", "        10         1")},
       {"UFF", "a count in words", replaced(plain, "        20         1", "    twenty         1")},
       {"UFF", "a negative count", replaced(plain, "        20         1", "       -20         1")},
       {"UFF", "data type 3", replaced(plain, "         4        20", "         3        20")},
       {"UFF", "an increment of zero", replaced(plain, "1.00000E-02", "0.00000E+00")},
       {"UFF", "an increment that is no number", replaced(plain, "1.00000E-02", "        NaN")},
       {"UFF", "another increment in one function", replaced(plain, "1.00000E-02", "2.00000E-02")},
       {"UFF", "direction 9", replaced(plain, "         1   1 NONE", "         1   9 NONE")},
       {"UFF", "text among the values",
        replaced(plain, "1.000000000000E+00", "abcdefghijklmnopqr")},
       {"UFF", "a dataset number in words", replaced(plain, "   164\n", "  text\n")},
       {"UFF", "unit factors of zero",
        replaced(plain, "1.00000000000000000D+00", "0.00000000000000000D+00")},
       {"UFF", "an unknown dataset", plain + "    -1\n  2420\n         1\n    -1\n"},
       {"UFF", "text behind the last dataset", plain + "the end\n"}});
}

void add_uff_binary(std::vector<Damage>& all) {
  const std::string whole = written(RecordFormat::uff);
  const std::string uff = of_another_program(whole);
  const std::string bytes = "          11         160";
  all.insert(
      all.end(),
      {{"UFF 58b", "one bit of a sample", with_changed_sample(whole)},
       {"UFF 58b", "hydrapod's dataset has another number",
        replaced(whole, " 99001\n", " 99081\n")},
       {"UFF 58b", "hydrapod's dataset and the name of the program are lost",
        replaced(of_another_program(whole), "of session", "of repeat ")},
       {"UFF 58b", "cut within the last function's values", cut(uff, uff.size() - 50)},
       {"UFF 58b", "more bytes declared than the file has",
        replaced(uff, bytes, "          11999999999999")},
       {"UFF 58b", "bytes and values do not fit", replaced(uff, bytes, "          11          80")},
       {"UFF 58b", "values beyond the file's size",
        replaced(uff, "         4        20", "         4 999999999")},
       {"UFF 58b", "byte order 3", replaced(uff, "58b     1", "58b     3")},
       {"UFF 58b", "floating point of a VAX",
        replaced(uff, "58b     1     2", "58b     1     1")}});
}

void add_mat(std::vector<Damage>& all) {
  const std::string mat = written(RecordFormat::mat5);
  const std::size_t samples = mat.find("samples") - 48;  // tag of the last variable
  all.insert(all.end(),
             {{"MAT 5", "cut within the header", cut(mat, 100)},
              {"MAT 5", "cut behind the header", cut(mat, 128)},
              {"MAT 5", "cut within the first variable", cut(mat, 160)},
              {"MAT 5", "cut before the samples", cut(mat, samples)},
              {"MAT 5", "cut within the tag of the samples", cut(mat, samples + 5)},
              {"MAT 5", "cut within the samples", cut(mat, mat.size() - 100)},
              {"MAT 5", "one bit of a sample", with_changed_sample(mat)},
              {"MAT 5", "no mark of the byte order", with_word(mat, 124, 0x20200100)},
              {"MAT 5", "the mark of the other byte order", with_word(mat, 124, 0x494D0100)},
              {"MAT 5", "4 GiB declared for a variable", with_word(mat, samples + 4, 0xFFFFFFFF)},
              {"MAT 5", "4 × 10⁹ columns declared", with_word(mat, samples + 36, 0xFFFFFFF0)},
              {"MAT 5", "16 × 10⁹ numbers declared twice over",
               with_word(with_word(mat, samples + 32, 0xFFFFFFF0), samples + 36, 0xFFFFFFF0)},
              {"MAT 5", "an unknown element", with_word(mat, 128, 77)},
              {"MAT 5", "numbers of an unknown type", with_word(mat, samples + 56, 77)},
              {"MAT 5", "a sample rate of NaN",
               replaced(mat, std::string("\0\0\0\0\0\0\x59\x40", 8),
                        std::string("\0\0\0\0\0\0\xf8\x7f", 8))},
              {"MAT 5", "a later version of the layout",
               replaced(mat, std::string("\0\0\0\0\0\0\xf0\x3f", 8),
                        std::string("\0\0\0\0\0\0\x08\x40", 8))}});
}

void add_hdf5(std::vector<Damage>& all) {
  const std::string hdf5 = written(RecordFormat::hdf5), mat = written(RecordFormat::mat73);
  all.insert(
      all.end(),
      {{"HDF5", "cut within the signature", cut(hdf5, 6)},
       {"HDF5", "cut within the header", cut(hdf5, 100)},
       {"HDF5", "cut in the middle", cut(hdf5, hdf5.size() / 2)},
       {"HDF5", "the last bytes are missing", cut(hdf5, hdf5.size() - 1)},
       {"HDF5", "a later version of the layout",
        replaced(hdf5, std::string("format_version\0", 15), std::string("format_versio_\0", 15))},
       {"HDF5", "'samples' has another name",
        replaced(hdf5, std::string("samples\0", 8), std::string("sambles\0", 8))},
       {"HDF5", "'channels' has another name",
        replaced(hdf5, std::string("channels\0", 9), std::string("chambers\0", 9))},
       {"HDF5", "one bit of a sample", with_changed_sample(hdf5)},
       {"MAT 7.3", "one bit of a sample", with_changed_sample(mat)},
       {"MAT 7.3", "cut in the middle", cut(mat, mat.size() / 2)}});
}

/// What a reader says, and what it could read.
std::string said(const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder / "FILE";
  write_text(path, bytes);
  std::string text;
  const auto add = [&](const base::Diagnostic& diagnostic) {
    base::Diagnostic local = diagnostic;
    local.file = "FILE";
    text += (text.empty() ? "" : "<br>") + local.text();
  };
  try {
    const auto [read, notes] = data::read_record(path);
    for (const auto& note : notes) add(note);
    return text + fmt::format("{}read: {} channels, {} samples", text.empty() ? "" : "<br>",
                              read.header.channels.size(), read.samples.rows());
  } catch (const base::InputError& error) {
    for (const auto& diagnostic : error.diagnostics()) add(diagnostic);
    return text;
  }
}

std::vector<Damage> damages() {
  std::vector<Damage> all;
  add_csv(all);
  add_uff(all);
  add_uff_binary(all);
  add_mat(all);
  add_hdf5(all);
  return all;
}

constexpr const char* head =
    "# Damaged records\n\n"
    "What `hydrapod record` says of files that are damaged, one row per file. Each is made from "
    "the same\n"
    "record of three channels and twenty samples. The table is made by `tests/data/"
    "damaged_files_test.cpp`,\nwhich compares it to the letter.\n\n"
    "| format | damage | what is said |\n| --- | --- | --- |\n";

TEST(DamagedFiles, AreToldApartToTheLetter) {
  std::string table = head;
  for (const Damage& damage : damages())
    table += fmt::format("| {} | {} | {} |\n", damage.format, damage.what, said(damage.bytes));
  const auto place = source_file("docs/validation/damaged-records.md");
  const std::string page = read_text(place);
  const std::size_t end = std::min(page.find("\n## At random"), page.size());  // of another test
  if (std::getenv("HYDRAPOD_WRITE_TABLES") != nullptr) write_text(place, table + page.substr(end));
  EXPECT_GE(damages().size(), 30U);
  EXPECT_EQ(table, page.substr(0, end));
}

/// Cut at every thirteenth byte: an answer, never a crash, and no more samples than there
/// were.
TEST(DamagedFiles, CutAnywhereTheyAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "cut";
  for (const RecordFormat format :
       {RecordFormat::csv, RecordFormat::uff, RecordFormat::uff_ascii, RecordFormat::mat5}) {
    const std::string whole = written(format);
    for (std::size_t size = 1; size < whole.size(); size += 13) {
      write_text(path, whole.substr(0, size));
      try {
        EXPECT_LE(data::read_record(path).record.samples.rows(), 20);
      } catch (const base::InputError&) {
      }
    }
  }
}

/// Every eleventh byte changed in turn.
TEST(DamagedFiles, WithAnyByteChangedTheyAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "changed";
  for (const RecordFormat format :
       {RecordFormat::csv, RecordFormat::uff, RecordFormat::uff_ascii, RecordFormat::mat5}) {
    std::string whole = written(format);
    for (std::size_t at = 0; at < whole.size(); at += 11) {
      const char before = whole[at];
      whole[at] = static_cast<char>(before ^ (at % 2 == 0 ? 0x80 : 0x15));
      write_text(path, whole);
      try {
        data::read_record(path);
      } catch (const base::InputError&) {
      }
      whole[at] = before;
    }
  }
}

}  // namespace
}  // namespace hydrapod::test
