/// Every byte of an HDF5 record and of a MATLAB 7.3 file with each bit changed, and with 0 and 255.

#include <gtest/gtest.h>

#include "damaged_hdf5.hpp"
#include "data/variable_file.hpp"

namespace hydrapod::test {
namespace {

class HostileHdf5Long : public testing::TestWithParam<data::RecordFormat> {};

TEST_P(HostileHdf5Long, AnyByteMayBeChanged) {
  if (!data::hdf5_is_read_apart()) GTEST_SKIP() << "the library is called in this process here";
  DamagedHdf5 file(GetParam());
  for (std::size_t place = 0; place < file.bytes().size(); ++place) {
    for (unsigned bit = 0; bit < 8; ++bit)
      file.read_with(place, static_cast<char>(file.bytes()[place] ^ (1 << bit)));
    for (const int value : {0, 255}) file.read_with(place, static_cast<char>(value));
  }
  const auto [crashed, refused, read] = file.counts();
  std::printf("%zu bytes: %d crashed, %d refused, %d read\n", file.bytes().size(), crashed, refused,
              read);
}

INSTANTIATE_TEST_SUITE_P(Formats, HostileHdf5Long,
                         testing::Values(data::RecordFormat::hdf5, data::RecordFormat::mat73),
                         [](const auto& info) {
                           return std::string(data::format_text(info.param));
                         });

}  // namespace
}  // namespace hydrapod::test
