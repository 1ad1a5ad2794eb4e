/// MAT files of version 5 put together by hand: both byte orders, every type of number, negative
/// and missing samples, elements of odd lengths and those that stand within their tag.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "hydrapod/data/record_io.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Types of data elements, from the format's description.
enum Type : std::uint32_t {
  int8 = 1,
  uint8 = 2,
  int16 = 3,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  single = 7,
  double_precision = 9,
  int64 = 12,
  uint64 = 13,
  matrix = 14
};
constexpr std::uint32_t class_double = 6;

class Mat5 {
 public:
  explicit Mat5(bool big_endian) : big_endian_(big_endian) {
    text_ = "MATLAB 5.0 MAT-file, by hand";
    text_.resize(124, ' ');
    text_ += number(std::uint16_t{0x0100}) + number(static_cast<std::uint16_t>('M' << 8 | 'I'));
  }

  /// A column of numbers, stored as Number is.
  template <class Number>
  void add(const std::string& name, Type type, const std::vector<Number>& values) {
    std::string numbers;
    for (const Number value : values) numbers += number(value);
    text_ += element(matrix, element(uint32, number(class_double) + number(std::uint32_t{0})) +
                                 element(int32, number(static_cast<std::int32_t>(values.size())) +
                                                    number(std::int32_t{1})) +
                                 element(int8, name) + element(type, numbers));
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class Number>
  [[nodiscard]] std::string number(Number value) const {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (big_endian_) std::reverse(bytes.begin(), bytes.end());
    return bytes;
  }
  /// Up to four bytes stand within the tag.
  [[nodiscard]] std::string element(std::uint32_t type, std::string bytes) const {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    if (size <= 4) {
      bytes.resize(4, '\0');
      return number(size << 16U | type) + bytes;
    }
    bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
    return number(type) + number(size) + bytes;
  }

  bool big_endian_;
  std::string text_{};
};

data::Record read(const Mat5& file) {
  const TemporaryFolder folder;
  write_text(folder / "r.mat", file.text());
  return data::read_record(folder / "r.mat").record;
}

void expect_samples(const data::Record& record, const char* name,
                    const std::vector<double>& expected) {
  const auto channel = data::find_channel(record.header, name);
  ASSERT_TRUE(channel) << name;
  ASSERT_EQ(record.samples.rows(), static_cast<Eigen::Index>(expected.size()));
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const double found =
        record.samples(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(*channel));
    if (std::isnan(expected[k]))
      EXPECT_TRUE(std::isnan(found)) << name << ' ' << k;
    else
      EXPECT_EQ(found, expected[k]) << name << ' ' << k;
  }
}

class Mat5Numbers : public testing::TestWithParam<bool> {};

TEST_P(Mat5Numbers, OfEveryTypeAreRead) {
  Mat5 file(GetParam());
  file.add<std::uint16_t>("fs", uint16, {250});
  file.add<std::int8_t>("a", int8, {-128, -1, 0, 5, 127});
  file.add<std::uint8_t>("b", uint8, {255, 1, 0, 128, 7});
  file.add<std::int16_t>("c", int16, {-32768, -2, 0, 258, 32767});
  file.add<std::uint16_t>("d", uint16, {65535, 2, 0, 32769, 513});
  file.add<std::int32_t>("e", int32, {-2147483647, -3, 0, 66051, 2147483647});
  file.add<std::uint32_t>("f", uint32, {4294967295, 3, 0, 2147483649, 16909060});
  file.add<float>("g", single, {-1.5F, 3.25F, NAN, 0.0F, -65536.5F});
  file.add<double>("h", double_precision, {-1.7e-300, nan, 3.1415926535897931, -0.1, 2.5e200});
  file.add<std::int64_t>("i", int64, {-5, 4, 72057594037927936, 0, -1099511627776});
  file.add<std::uint64_t>("j", uint64, {5, 6, 7, 1099511627776, 0});
  const auto record = read(file);
  EXPECT_EQ(record.header.sample_rate, 250.0);
  expect_samples(record, "a", {-128, -1, 0, 5, 127});
  expect_samples(record, "b", {255, 1, 0, 128, 7});
  expect_samples(record, "c", {-32768, -2, 0, 258, 32767});
  expect_samples(record, "d", {65535, 2, 0, 32769, 513});
  expect_samples(record, "e", {-2147483647, -3, 0, 66051, 2147483647});
  expect_samples(record, "f", {4294967295, 3, 0, 2147483649, 16909060});
  expect_samples(record, "g", {-1.5, 3.25, nan, 0.0, -65536.5});
  expect_samples(record, "h", {-1.7e-300, nan, 3.1415926535897931, -0.1, 2.5e200});
  expect_samples(record, "i", {-5, 4, 72057594037927936, 0, -1099511627776});
  expect_samples(record, "j", {5, 6, 7, 1099511627776, 0});
}

TEST_P(Mat5Numbers, ThatStandWithinTheirTagAreRead) {
  Mat5 file(GetParam());
  file.add<std::int8_t>("dt", int8, {2});
  file.add<std::int8_t>("a", int8, {-3, 7, -11, 13});
  file.add<std::uint8_t>("b", uint8, {203, 7, 211, 13});
  const auto record = read(file);
  EXPECT_EQ(record.header.sample_rate, 0.5);
  expect_samples(record, "a", {-3, 7, -11, 13});
  expect_samples(record, "b", {203, 7, 211, 13});
}

INSTANTIATE_TEST_SUITE_P(ByteOrders, Mat5Numbers, testing::Values(false, true),
                         [](const auto& big) { return big.param ? "Big" : "Little"; });

}  // namespace
}  // namespace hydrapod::test
