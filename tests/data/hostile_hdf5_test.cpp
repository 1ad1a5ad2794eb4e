/// HDF5 files of anybody: whatever stands in them, no crash, no other file that is read, no work
/// without end. The files are made here with the HDF5 library.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <complex>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "damaged_hdf5.hpp"
#include "data/apart.hpp"

namespace hydrapod::test {
namespace {

using data::RecordFormat;
using testing::ElementsAre;
using testing::HasSubstr;

// The library itself

/// An HDF5 file that is being made, with its sample rate.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t rate = H5Acreate2(file_, "fs", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    const double hertz = 50.0;
    H5Awrite(rate, H5T_NATIVE_DOUBLE, &hertz);
    H5Aclose(rate);
    H5Sclose(space);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() { H5Fclose(file_); }
  [[nodiscard]] hid_t id() const { return file_; }

  /// A list of numbers 0, 1, 2, … with these properties, or of zeros.
  void list(const char* name, hsize_t count, hid_t properties = H5P_DEFAULT, bool zeros = false,
            hid_t type = H5T_IEEE_F64LE) const {
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t set = H5Dcreate2(file_, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(set, 0) << name;
    std::vector<double> values(count);
    if (!zeros) std::iota(values.begin(), values.end(), 0.0);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Sclose(space);
  }

 private:
  hid_t file_;
};

struct Read {
  std::vector<std::string> channels{}, said{};
};

Read read(const std::filesystem::path& path) {
  const auto [record, notes] = data::read_record(path);
  Read result;
  for (const auto& channel : record.header.channels) result.channels.push_back(channel.name);
  for (const auto& note : notes) result.said.push_back(note.message);
  return result;
}

/// Such a byte was reported to crash libhdf5 1.10.8 in H5Aexists; whether it does depends on what
/// stands around it in memory.
TEST(HostileHdf5, TheByteBeforeAnAttributeNameMayHaveAnyValue) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "the library is called in this process here";
  DamagedHdf5 file(RecordFormat::hdf5);
  const std::size_t place = file.bytes().find("start_s") - 1;
  for (int value = 0; value < 256; ++value) {
    const bool changed = static_cast<char>(value) != file.bytes()[place];
    const DamagedRead result = file.read_with(place, static_cast<char>(value));
    if (!changed) EXPECT_EQ(result.refusal, "");
    if (!result.refusal.empty()) continue;
    EXPECT_TRUE(result.same_samples) << value;
    using enum data::ChecksumFinding;
    EXPECT_EQ(result.checksum, result.same_header ? holds : differs) << value;
    if (!changed) EXPECT_TRUE(result.same_header);
  }
}

/// Then a record of hydrapod looks like one of another program, without roles and a checksum.
TEST(HostileHdf5, RecordsWithoutTheirAttributesAreSaid) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "r.h5";
  data::Record record;
  record.header.channels = {{.name = "u", .unit = "N"}, {.name = "y", .unit = "m"}};
  record.header.sample_rate = 100.0;
  record.samples = data::Samples::Random(40, 2);
  data::write_record(path, record, RecordFormat::hdf5);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
  for (int left = H5Aget_num_attrs(root); left > 0; --left)
    ASSERT_GE(H5Adelete_by_idx(root, ".", H5_INDEX_NAME, H5_ITER_INC, 0, H5P_DEFAULT), 0);
  H5Gclose(root);
  H5Fclose(file);
  const auto read_again = data::read_record(path, {.sample_rate = 100.0});
  EXPECT_EQ(read_again.record.samples, record.samples);
  EXPECT_TRUE(std::ranges::any_of(read_again.notes, [](const auto& note) {
    return note.message.find("whose mark is damaged") != std::string::npos;
  }));
}

/// A byte in 389; the whole file in the long test.
TEST(HostileHdf5, AnyByteMayBeChanged) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "the library is called in this process here";
  for (const auto format : {RecordFormat::hdf5, RecordFormat::mat73}) {
    DamagedHdf5 file(format);
    for (std::size_t place = 0; place < file.bytes().size(); place += 389)
      file.read_with(place,
                     static_cast<char>(file.bytes()[place] ^ (place % 2 == 0 ? 0x01 : 0x80)));
    EXPECT_GE(file.counts().read, 10);
  }
}

/// In the process that reads, and in this one, which could open the other file.
TEST(HostileHdf5, NumbersOfAnotherFileAreNotRead) {
  const TemporaryFolder folder;
  const auto path = folder / "evil.h5", secret = folder / "secret", other = folder / "other.h5";
  write_text(secret, std::string(800, 's'));
  { NewFile(other).list("x", 100); }
  {
    const NewFile file(path);
    file.list("good", 100);
    const hid_t external = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(external, secret.c_str(), 0, 100);
    file.list("stored elsewhere", 100, external, false, H5T_STD_U8LE);
    H5Pclose(external);
    const hid_t virtual_list = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t count = 100;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Pset_virtual(virtual_list, space, other.c_str(), "x", space);
    file.list("virtual", 100, virtual_list);
    H5Sclose(space);
    H5Pclose(virtual_list);
    H5Lcreate_external(other.c_str(), "/x", file.id(), "linked", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/linked", file.id(), "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/soft", file.id(), "soft twice", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external(other.c_str(), "/", file.id(), "all of it", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/all of it/x", file.id(), "through it", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/all of it", file.id(), "as a group", H5P_DEFAULT, H5P_DEFAULT);
  }
  const auto [channels, said] = read(path);
  EXPECT_THAT(channels, ElementsAre("good"));
  EXPECT_THAT(
      said,
      testing::IsSupersetOf(
          {"'stored elsewhere' keeps its numbers in another file: left out",
           "'virtual' is put together from other datasets: left out",
           "'linked' is a link to another file: left out",
           "'all of it' is a link to another file: left out", "'soft' cannot be opened: left out",
           "'soft twice' cannot be opened: left out", "'through it' cannot be opened: left out",
           "'as a group' cannot be opened: left out"}));
  data::Notes notes(path);
  const auto here = data::open_hdf5_here(path, notes);
  std::vector<std::string> names;
  for (const auto& variable : here->variables()) names.push_back(variable.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("fs", "good"));
}

TEST(HostileHdf5, FiltersOfOthersAreNamed) {
  const TemporaryFolder folder;
  {
    const NewFile file(folder / "f.h5");
    file.list("good", 100);
    const hid_t lzf = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 100;
    H5Pset_chunk(lzf, 1, &chunk);
    H5Pset_filter(lzf, 32000, H5Z_FLAG_OPTIONAL, 0, nullptr);
    file.list("by h5py", 100, lzf);
    H5Pclose(lzf);
  }
  const auto [channels, said] = read(folder / "f.h5");
  EXPECT_THAT(channels, ElementsAre("good"));
  EXPECT_THAT(said, testing::Contains(HasSubstr("'by h5py' has the filter 32000, which")));
}

TEST(HostileHdf5, LinksThatGoInACircleEnd) {
  const TemporaryFolder folder;
  {
    const NewFile file(folder / "f.h5");
    file.list("good", 100);
    for (int k = 0; k < 40; ++k)  // 40^6 groups, followed without end
      H5Lcreate_hard(file.id(), "/", file.id(), fmt::format("again {}", k).c_str(), H5P_DEFAULT,
                     H5P_DEFAULT);
  }
  EXPECT_THAT(read(folder / "f.h5").channels, ElementsAre("good"));
}

/// 64 chunks of ten bytes that say they hold four million numbers each take minutes to be read.
TEST(HostileHdf5, NumbersBeyondTheFileAreNotRead) {
  const TemporaryFolder folder;
  {
    const NewFile file(folder / "f.h5");
    file.list("good", 100);
    const hsize_t size[2] = {5, hsize_t{1} << 28U}, chunk[2] = {1, hsize_t{1} << 22U};
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(2, size, nullptr);
    H5Pset_chunk(list, 2, chunk);
    H5Pset_scaleoffset(list, H5Z_SO_FLOAT_DSCALE, 3);
    const hid_t set =
        H5Dcreate2(file.id(), "bomb", H5T_IEEE_F32LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    for (hsize_t k = 0; k < 64; ++k) {
      const hsize_t place[2] = {0, k * chunk[1]};
      ASSERT_GE(H5Dwrite_chunk(set, H5P_DEFAULT, 0, place, 10, "0123456789"), 0);
    }
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(list);
  }
  const auto [channels, said] = read(folder / "f.h5");
  EXPECT_THAT(channels, ElementsAre("good"));
  EXPECT_THAT(
      said, testing::Contains(HasSubstr("'bomb' declares 268435456 numbers, which " +
                                        fmt::format("{} bytes of a file cannot hold",
                                                    std::filesystem::file_size(folder / "f.h5")))));
}

double processor_seconds(int who) {
  rusage used{};
  ::getrusage(who, &used);
  const auto seconds = [](timeval t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}
double processor_seconds() {
  return processor_seconds(RUSAGE_SELF) + processor_seconds(RUSAGE_CHILDREN);
}

hid_t compressed(hsize_t chunk) {
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(list, 1, &chunk);
  H5Pset_deflate(list, 1);
  return list;
}

/// Chunks larger than HDF5's cache of 1 MiB were unpacked for each block of samples: 30 times here.
TEST(HostileHdf5, EachChunkIsUnpackedOnce) {
  const TemporaryFolder folder;
  constexpr hsize_t samples = 1U << 21U;
  {
    const NewFile file(folder / "f.h5");
    const hid_t list = compressed(samples);
    file.list("a", samples, list);
    file.list("b", samples, list);
    H5Pclose(list);
  }
  const double begin = processor_seconds();
  {  // both, at once
    const hid_t file = H5Fopen((folder / "f.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    std::vector<double> values(samples);
    for (const char* name : {"a", "b"}) {
      const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
      H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      H5Dclose(set);
    }
    H5Fclose(file);
  }
  const double once = processor_seconds() - begin;
  std::int64_t rows = 0;
  {
    data::RecordSet set({(folder / "f.h5").string()});
    set.stream([&](std::size_t, const auto& block) {
      EXPECT_EQ(block(block.rows() - 1, 1), rows + block.rows() - 1);
      rows += block.rows();
      return true;
    });
  }
  EXPECT_EQ(rows, samples);
  EXPECT_LT(processor_seconds() - begin - once, 6.0 * once + 0.05);
}

TEST(HostileHdf5, ChunksBeyondTheMemoryForThemAreNamed) {
  const TemporaryFolder folder;
  constexpr hsize_t samples = 1U << 23U;  // 64 MiB
  {
    const NewFile file(folder / "f.h5");
    const hid_t list = compressed(samples);
    for (const char* name : {"a", "b", "c", "d", "e"}) file.list(name, samples, list, true);
    H5Pclose(list);
  }
  data::RecordSet set({(folder / "f.h5").string()});
  EXPECT_EQ(set.header().channels.size(), 4U);
  ASSERT_FALSE(set.notes().empty());
  EXPECT_THAT(set.notes().front().message,
              HasSubstr("'e' has chunks of 64 MiB, too large to be read beside the others (256 MiB "
                        "for all; h5repack -l CHUNK=SIZE makes smaller ones): left out"));
}

// The process that reads

using data::Notes;
using data::VariableFile;

/// One list of 10⁶ numbers, which does something else from some place on.
class Numbers : public VariableFile {
 public:
  Numbers() {
    variables_.push_back({.name = "x", .fast = 1'000'000, .sizes = {1000, 250, 4}, .unit = "mm"});
    variables_.push_back({.name = "odd", .sizes = {1ULL << 40U, 1ULL << 40U}});
  }
  bool read(std::size_t, std::uint64_t, std::uint64_t, std::uint64_t first, std::uint64_t count,
            double* out) override {
    if (first >= 900'000) misbehave();
    std::iota(out, out + count, static_cast<double>(first));
    return true;
  }
  bool read_all(std::size_t, std::vector<std::complex<double>>& out) override {
    misbehave();
    out.resize(1'000'000);
    for (std::size_t k = 0; k < out.size(); ++k)
      out[k] = {static_cast<double>(k), -0.5 * static_cast<double>(k)};
    return true;
  }
  virtual void misbehave() {}
};

void nothing() {}
void crash() { ::raise(SIGSEGV); }
void hang() {
  for (volatile int k = 0;; k = k + 1) {
  }
}
void wait_for_ever() {
  for (;;) ::pause();
}

template <void (*Do)()>
std::unique_ptr<VariableFile> misbehave_at_once(const std::string&, Notes&) {
  Do();
  return std::make_unique<Numbers>();
}
template <void (*Do)()>
std::unique_ptr<VariableFile> misbehave_later(const std::string&, Notes&) {
  struct Later : Numbers {
    void misbehave() override { Do(); }
  };
  return std::make_unique<Later>();
}

std::string said(data::OpenVariableFile open, const data::ApartLimits& limits = {}) {
  Notes notes("FILE");
  try {
    const auto file = data::open_apart("FILE", notes, open, "the library", limits);
    std::vector<double> values(1'000'000);
    for (std::uint64_t at = 0; at < values.size(); at += 100'000)
      file->read(0, 0, 1, at, 100'000, values.data() + at);
    EXPECT_EQ(values[777'777], 777'777.0);
    return "";
  } catch (const base::InputError& error) {
    return error.what();
  }
}

TEST(ReadApart, WhatEndsTheProcessIsAnErrorAboutTheFile) {
  EXPECT_EQ(said(misbehave_later<nothing>), "");
  for (const auto open : {misbehave_at_once<crash>, misbehave_later<crash>})
    EXPECT_EQ(said(open),
              "FILE: error: cannot be read: the library crashed on it; the file is damaged");
  for (const auto open : {misbehave_at_once<hang>, misbehave_later<hang>})
    EXPECT_EQ(said(open, {.seconds = 0.1}),
              "FILE: error: cannot be read: the library takes longer than 0.1 s for a part of it; "
              "the file is damaged");
  for (const auto open : {misbehave_at_once<wait_for_ever>, misbehave_later<wait_for_ever>})
    EXPECT_EQ(said(open, {.patience = 0.1}), "FILE: error: cannot be read: no answer within 0.1 s");
}

/// In pieces of the window that the processes share.
TEST(ReadApart, WholeArraysOfComplexNumbersComeOver) {
  Notes notes("FILE");
  const auto file = data::open_apart("FILE", notes, misbehave_later<nothing>, "the library");
  EXPECT_EQ(file->variables()[0].sizes, (std::vector<std::uint64_t>{1000, 250, 4}));
  EXPECT_EQ(file->variables()[0].unit, "mm");
  std::vector<std::complex<double>> all;
  ASSERT_TRUE(file->read_all(0, all));
  ASSERT_EQ(all.size(), 1'000'000U);
  for (const std::size_t k : {0U, 65'535U, 65'536U, 777'777U, 999'999U})
    EXPECT_EQ(all[k], std::complex<double>(static_cast<double>(k), -0.5 * static_cast<double>(k)));
  EXPECT_FALSE(file->read_all(1, all)) << "more than fits into memory";
  const auto other = data::open_apart("FILE", notes, misbehave_later<crash>, "the library");
  EXPECT_THROW(other->read_all(0, all), base::InputError);
}

std::unique_ptr<VariableFile> take_memory(const std::string&, Notes&) {
  std::vector<std::vector<char>> all;
  for (;;) all.emplace_back(1U << 24U, '\1');
}

TEST(ReadApart, MemoryIsLimited) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "a sanitizer ends a process without memory";
  EXPECT_EQ(said(take_memory, {.bytes = 1U << 27U}),
            "FILE: error: cannot be read: more than 128 MiB of memory are needed for it: it is "
            "damaged, or its arrays are larger than that");
}

std::unique_ptr<VariableFile> complain(const std::string& place, Notes& notes) {
  notes.add("odd");
  notes.fail("this is " + std::string(::access(place.c_str(), R_OK) == 0 ? "there" : "not there"),
             3, 4);
}

TEST(ReadApart, WhatTheReaderSaysIsPassedOn) {
  Notes notes("FILE");
  notes.add("before");
  try {
    data::open_apart("FILE", notes, complain, "the library");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "FILE: warning: before\nFILE: warning: odd\nFILE:3:4: error: this is not there");
  }
}

/// It has the file and may open it once more; no other, and nothing of this process.
std::unique_ptr<VariableFile> open_others(const std::string& place, Notes& notes) {
  notes.add(fmt::format("the file: {}", ::open(place.c_str(), O_RDONLY) >= 0));
  notes.add(fmt::format("another: {}", ::open("/etc/passwd", O_RDONLY) >= 0));
  int open = 0;
  for (int k = 0; k < 1000; ++k) open += ::fcntl(k, F_GETFD) >= 0;
  notes.add(fmt::format("open: {}", open));
  notes.fail("end");
}

TEST(ReadApart, NoOtherFileCanBeOpened) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "a sanitizer opens files itself";
  const TemporaryFolder folder;
  write_text(folder / "f", "text");
  const int mine = ::open((folder / "f").c_str(), O_RDONLY);
  Notes notes("F");
  try {
    data::open_apart(folder / "f", notes, open_others, "the library");
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the file: true\n"));
    EXPECT_THAT(error.what(), HasSubstr("another: false\n"));
    EXPECT_THAT(error.what(), HasSubstr("open: 6\n"));  // nothing ×3, socket, file, file
  }
  ::close(mine);
}

/// Whole lines, parts of lines, lines longer than the memory that is shared, back and forth.
TEST(ReadApart, NumbersAreThoseOfTheFile) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "a sanitizer needs more than the limits allow";
  const TemporaryFolder folder;
  const auto path = folder / "f.h5";
  constexpr hsize_t size[2] = {7, 300'001};
  {
    const NewFile file(path);
    const hid_t space = H5Screate_simple(2, size, nullptr);
    const hid_t set =
        H5Dcreate2(file.id(), "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    std::vector<double> values(size[0] * size[1]);
    std::iota(values.begin(), values.end(), 0.0);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Sclose(space);
  }
  Notes notes(path);
  const auto file = data::open_apart(path, notes, data::open_hdf5_here, "the library");
  ASSERT_EQ(file->variables().size(), 2U);
  const std::size_t x = file->variables()[1].name == "x" ? 1 : 0;
  std::vector<double> values(size[0] * size[1], -1.0);
  const auto expect_numbers = [&](std::uint64_t line, std::uint64_t lines, std::uint64_t first,
                                  std::uint64_t count) {
    ASSERT_TRUE(file->read(x, line, lines, first, count, values.data()));
    for (std::uint64_t l = 0; l < lines; ++l)
      for (std::uint64_t k = 0; k < count; k += 997)
        ASSERT_EQ(values[l * count + k], static_cast<double>((line + l) * size[1] + first + k));
  };
  expect_numbers(0, 7, 0, size[1]);
  expect_numbers(2, 3, 0, size[1]);
  for (const std::uint64_t first : {0U, 1'000U, 33'000U, 20U, 290'000U, 299'999U})
    for (const std::uint64_t line : {0U, 6U, 3U}) {
      expect_numbers(line, 1, first, 2);
      expect_numbers(line, 1, first, std::min<std::uint64_t>(size[1] - first, 5'000));
    }
  EXPECT_FALSE(file->read(x, 7, 1, 0, 10, values.data()));
}

}  // namespace
}  // namespace hydrapod::test
