/// Which bytes packets have, and what descriptions of them may say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/realtime/realtime.hpp"
#include "support/random.hpp"

namespace hydrapod::realtime {
namespace {

using testing::HasSubstr;
using Bytes = std::array<std::byte, largest_packet>;

std::uint64_t number_at(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, bytes.data() + at, size);  // this test runs where numbers are little-endian
  return bits;
}
double value_at(const Bytes& bytes, std::size_t at) {
  return std::bit_cast<double>(number_at(bytes, at, 8));
}

Vector6 ugly(test::Random& random) {
  Vector6 values;
  for (double& value : values) value = random.uniform(-1.7, 2.3);
  return values;
}

Command some_command() {
  test::Random random(71);
  return {.session = 0x8123456789abcdef,
          .sequence = 987654321987,
          .time = 1234567890123456789,
          .mode = 2,
          .flags = 1,
          .displacement = ugly(random),
          .rate = ugly(random),
          .drive = ugly(random),
          .wrench = ugly(random),
          .next_wrench = ugly(random)};
}

TEST(Layout, OfHydrapodHasThePlacesOfItsDocument) {
  const Layout layout = native_layout(9);
  EXPECT_EQ(layout.command.size, 276U);
  EXPECT_EQ(layout.sensors.size, 612U);
  const Command command = some_command();
  Bytes bytes{};
  ASSERT_EQ(encode(layout, command, bytes.data()), 276U);
  EXPECT_EQ(std::memcmp(bytes.data(), "HYDC\x01\x00\x02\x01", 8), 0);
  EXPECT_EQ(number_at(bytes, 8, 8), command.session);
  EXPECT_EQ(number_at(bytes, 16, 8), command.sequence);
  EXPECT_EQ(number_at(bytes, 24, 8), command.time);
  EXPECT_EQ(value_at(bytes, 32 + 8 * 2), command.displacement[2]);
  EXPECT_EQ(value_at(bytes, 80 + 8 * 5), command.rate[5]);
  EXPECT_EQ(value_at(bytes, 128 + 8 * 1), command.drive[1]);
  EXPECT_EQ(value_at(bytes, 176), command.wrench[0]);
  EXPECT_EQ(value_at(bytes, 224 + 8 * 4), command.next_wrench[4]);
  Sensors sensors;
  sensors.answered = 77;
  sensors.counters.trips = 5;
  sensors.length[0] = 0.8712345;
  sensors.platform[2] = -1.25e-3;
  sensors.accelerometer[8] = 9.5;
  ASSERT_EQ(encode(layout, sensors, bytes.data()), 612U);
  EXPECT_EQ(std::memcmp(bytes.data(), "HYDS\x01\x00\x00\x00", 8), 0);
  EXPECT_EQ(number_at(bytes, 32, 8), 77U);
  EXPECT_EQ(number_at(bytes, 48 + 4 * 10, 4), 5U);
  EXPECT_EQ(value_at(bytes, 96), sensors.length[0]);
  EXPECT_EQ(value_at(bytes, 384 + 8 * 2), sensors.platform[2]);
  EXPECT_EQ(value_at(bytes, 536 + 8 * 8), 9.5);
}

TEST(Layout, OfElectricCylindersHasMotorsInPlaceOfOil) {
  const Layout layout = native_layout(9, model::LegType::screw);
  Sensors sensors;
  sensors.torque[5] = 17.25;
  sensors.motor_speed[0] = -3.5;
  sensors.valve[0] = 0.125;
  sensors.nut[3] = 0.43;
  sensors.cap_pressure.setConstant(1e5);
  Bytes bytes{};
  ASSERT_EQ(encode(layout, sensors, bytes.data()), 612U);
  EXPECT_EQ(value_at(bytes, 144 + 8 * 5), 17.25);
  EXPECT_EQ(value_at(bytes, 192), -3.5);
  EXPECT_EQ(value_at(bytes, 288), 0.125);
  EXPECT_EQ(value_at(bytes, 336 + 8 * 3), 0.43);
  Sensors as_oil;  // equally long, but torques are no pressures
  EXPECT_FALSE(decode(native_layout(9), {bytes.data(), 612}, as_oil));
  const std::string text = layout_text(layout);
  EXPECT_EQ(layout_text(parse_layout(text, "own.toml")), text);
  EXPECT_THAT(text, HasSubstr("{ name = \"motor_speed\", type = \"f64\" },"));
}

TEST(Layout, PacketsComeBackBitForBit) {
  const Layout layout = native_layout(3);
  const Command command = some_command();
  Bytes bytes{};
  const std::size_t size = encode(layout, command, bytes.data());
  Command back;
  ASSERT_TRUE(decode(layout, {bytes.data(), size}, back));
  EXPECT_EQ(back.session, command.session);
  EXPECT_EQ(back.sequence, command.sequence);
  EXPECT_EQ(back.displacement, command.displacement);
  EXPECT_EQ(back.next_wrench, command.next_wrench);
  for (std::size_t at = 0; at < size; ++at)  // no bit is without meaning
    for (int bit = 0; bit < 8; ++bit) {
      bytes[at] ^= std::byte{1} << bit;
      EXPECT_FALSE(decode(layout, {bytes.data(), size}, back)) << at << '.' << bit;
      bytes[at] ^= std::byte{1} << bit;
    }
  EXPECT_FALSE(decode(layout, {bytes.data(), size - 1}, back));
  EXPECT_FALSE(decode(layout, {bytes.data(), size + 1}, back));
  EXPECT_FALSE(decode(layout, {}, back));
}

TEST(Layout, CommandsAreFinite) {
  const Layout layout = native_layout(0);
  for (const double odd : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Command command = some_command(), back;
    command.rate[3] = odd;
    Bytes bytes{};
    const std::size_t size = encode(layout, command, bytes.data());
    EXPECT_FALSE(decode(layout, {bytes.data(), size}, back));
  }
}

TEST(Layout, ItsTextReadsAsItself) {
  for (const int accelerometers : {0, 9, most_accelerometers}) {
    const Layout layout = native_layout(accelerometers);
    const std::string text = layout_text(layout);
    EXPECT_EQ(layout_text(parse_layout(text, "own.toml")), text);
    EXPECT_THAT(text, HasSubstr("{ name = \"displacement\", type = \"f64\" },"));
    EXPECT_THAT(text, HasSubstr("#   32 …   79  x y z m, rx ry rz rad"));
  }
}

/// Fields around the one that is looked at.
Layout with_field(const std::string& field, const std::string& more = "") {
  return parse_layout(
      more + "command = [ " + field + " ]\nsensors = [ { name = \"sequence\", type = \"u8\" } ]\n",
      "vendor.toml");
}

TEST(Layout, IntegersAreRoundedAndHeldAtTheirLimits) {
  const Layout layout = with_field(
      "{ name = \"displacement.x\", type = \"i16\", unit = \"mm\", factor = 0.01 }, "
      "{ name = \"displacement.rz\", type = \"u8\", unit = \"deg\", offset = -10 }",
      "byte_order = \"big\"\n");
  ASSERT_EQ(layout.command.size, 3U);
  const auto coded = [&](double x, double rz) {
    Command command;
    command.displacement[0] = x;
    command.displacement[5] = rz;
    Bytes bytes{};
    encode(layout, command, bytes.data());
    return bytes;
  };
  const double degree = M_PI / 180.0;
  Bytes bytes = coded(-1.2345e-3, 3.2 * degree);
  EXPECT_EQ(std::to_integer<int>(bytes[0]), 0xff);  // −123 counts of 0.01 mm
  EXPECT_EQ(std::to_integer<int>(bytes[1]), 0x85);
  EXPECT_EQ(std::to_integer<int>(bytes[2]), 13);
  Command back;
  ASSERT_TRUE(decode(layout, {bytes.data(), 3}, back));
  EXPECT_NEAR(back.displacement[0], -1.23e-3, 1e-15);
  EXPECT_NEAR(back.displacement[5], 3.0 * degree, 1e-15);
  bytes = coded(1.0, -1.0);
  EXPECT_EQ(std::to_integer<int>(bytes[0]), 0x7f);
  EXPECT_EQ(std::to_integer<int>(bytes[1]), 0xff);
  EXPECT_EQ(std::to_integer<int>(bytes[2]), 0);
  bytes = coded(-1.0, 9.0);
  EXPECT_EQ(std::to_integer<int>(bytes[0]), 0x80);
  EXPECT_EQ(std::to_integer<int>(bytes[1]), 0x00);
  EXPECT_EQ(std::to_integer<int>(bytes[2]), 255);
}

/// The check values of the catalogue of CRCs, of the text "123456789".
TEST(Layout, ChecksumsAreThoseOfTheirNames) {
  std::string digits;
  for (const char digit : std::string("123456789"))
    digits +=
        "{ name = \"constant\", type = \"u8\", value = " + std::to_string(int{digit}) + " }, ";
  const auto sum = [&](const std::string& field) {
    const Layout layout = with_field(digits + field + ", { name = \"drive.1\", type = \"f32\" }");
    Bytes bytes{};
    encode(layout, Command{}, bytes.data());
    Command back;
    EXPECT_TRUE(decode(layout, {bytes.data(), layout.command.size}, back));
    return number_at(bytes, 9, layout.command.size - 13);
  };
  EXPECT_EQ(sum("{ name = \"crc32\", type = \"u32\" }"), 0xcbf43926U);
  EXPECT_EQ(sum("{ name = \"crc16\", type = \"u16\" }"), 0x6f91U);
  // the same digits behind a byte that does not count, and one that is not sent
  digits = "{ name = \"ignored\", type = \"u8\" }, " + digits;
  digits.erase(digits.rfind("{ name"));
  const Layout layout = with_field(digits +
                                   "{ name = \"crc16\", type = \"u16\", from = 1, extra = 57 }, "
                                   "{ name = \"drive.1\", type = \"f32\" }");
  Bytes bytes{};
  encode(layout, Command{}, bytes.data());
  EXPECT_EQ(number_at(bytes, 9, 2), 0x6f91U);
}

TEST(Layout, MistakesAreToldWithTheirPlaces) {
  const auto told = [](const std::string& text) -> std::string {
    try {
      parse_layout(text, "vendor.toml");
    } catch (const base::InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string sensors = "\nsensors = [ { name = \"sequence\", type = \"u8\" } ]\n";
  EXPECT_THAT(told("command = [\n  { name = \"displacment\", type = \"f64\" } ]" + sensors),
              HasSubstr("vendor.toml:2:12: error: command[0].name: is \"displacment\"; did you "
                        "mean \"displacement\"?"));
  EXPECT_THAT(told("command = [ { name = \"rate\", type = \"double\" } ]" + sensors),
              HasSubstr("type: is \"double\", expected one of u8, u16"));
  EXPECT_THAT(told("command = [ { name = \"rate\", type = \"f64\", unit = \"mm/s\" } ]" + sensors),
              HasSubstr("name the components one by one (\"rate.x\")"));
  EXPECT_THAT(told("command = [ { name = \"drive\", type = \"f64\", unit = \"mm\" } ]" + sensors),
              HasSubstr("command[0].unit: "));
  EXPECT_THAT(told("command = [ { name = \"drive\", type = \"f64\" }, { name = \"drive.3\", type = "
                   "\"f64\" } ]" +
                   sensors),
              HasSubstr("\"drive.3\" stands twice"));
  EXPECT_THAT(told("command = [ { name = \"constant\", type = \"u8\", value = 256 } ]" + sensors),
              HasSubstr("expected a whole number from 0 to 255"));
  EXPECT_THAT(told("command = [ { name = \"sequence\", type = \"u8\" } ]" + sensors),
              HasSubstr("has neither displacement nor drive"));
  EXPECT_THAT(told("command = [ { name = \"drive\", type = \"f64\", scale = 2 } ]" + sensors),
              HasSubstr("command[0].scale: unknown key, expected"));
  EXPECT_THAT(told("byte_order = \"middle\"\ncommand = 3" + sensors),
              testing::AllOf(HasSubstr("vendor.toml:1:14: error: byte_order"),
                             HasSubstr("vendor.toml:2:11: error: command: expected an array")));
  EXPECT_THAT(told("command = ["), HasSubstr("vendor.toml:1:"));
  std::string long_one = "command = [ { name = \"drive\", type = \"f64\" }";
  for (int k = 0; k < 200; ++k) long_one += ", { name = \"ignored\", type = \"u64\" }";
  EXPECT_THAT(told(long_one + " ]" + sensors), HasSubstr("expected at most 1400"));
}

TEST(Authentication, IsTheHmacOfTheStandard) {
  // calculated by Python's hmac
  const Key key{"Jefe, but with 32 bytes of secret"};
  const std::string text = "what do ya want for nothing?";
  const auto mac = authentication(key, Kind::command, std::as_bytes(std::span(text)));
  std::string hex;
  for (const std::byte byte : mac) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", std::to_integer<unsigned>(byte));
    hex += two;
  }
  EXPECT_EQ(hex, "cbbfbb3dcefc7335f950077f86efbd4e4f5754b372b43705c6598a29dfdad135");
  EXPECT_NE(mac, authentication(key, Kind::sensors, std::as_bytes(std::span(text))));
}

TEST(Address, IsAPortOrAHostWithOne) {
  EXPECT_EQ(parse_address("--udp", "5000").host, "127.0.0.1");
  EXPECT_EQ(parse_address("--udp", "10.0.0.7:5000").host, "10.0.0.7");
  EXPECT_EQ(parse_address("--udp", "[::1]:5000").host, "::1");
  EXPECT_EQ(parse_address("--udp", "[::1]:5000").port, "5000");
  for (const char* wrong : {"", "70000", "-1", "host", "a:b", "::1", "[::1]", "1:2:3", ":5", "5 5"})
    EXPECT_THROW(parse_address("--udp", wrong), base::InputError) << wrong;
}

}  // namespace
}  // namespace hydrapod::realtime
