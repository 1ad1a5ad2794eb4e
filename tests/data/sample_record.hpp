#pragma once
/// A record with everything that a format can stumble over.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hydrapod/data/record.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

inline data::RecordHeader sample_header() {
  using data::Direction;
  using data::Role;
  data::RecordHeader header;
  header.title = "Six white noises, \"level 2\"; 50 % – Prüfstand";
  header.channels = {{"demand x", "m", Direction::x, Role::excitation, 0},
                     {"demand ry", "rad", Direction::ry, Role::excitation, 0},
                     {"valve 3, current", "A", Direction::leg3, Role::drive, 103},
                     {"cap pressure \"A\"", "Pa", Direction::leg6, Role::response, 106},
                     {"acceleration -z", "m/s^2", Direction::minus_z, Role::response, 7},
                     {"gain", "1", Direction::none, Role::other, 0},
                     {"counter", "EU", Direction::none, Role::other, -2},
                     {"unknown", "", Direction::minus_rz, Role::response, 1}};
  header.sample_rate = 1706.6666666666667;
  header.start = -0.12345678901234567;
  header.date = "2026-11-20T09:00:00";
  header.repeat = 3;
  header.notes = "first line\n\n  third, with blanks \nback\\slash\tand tab\n";
  header.experiment = {
      .program = "hydrapod 0.9",
      .command = {"rig", "a \"b\".toml"},
      .machine = "name = \"ugly\"\r\n[platform]\nmass = \"894.3 kg\" # µ\n",
      .overrides = {"platform.mass=3 t"},
      .pose_name = "z=10 mm",
      .pose = {{0.1, -1.0 / 3.0, 1e-300, 0.0, -0.0, 2.5}},
      .model = "full",
      .excitation = data::ExcitationNote{.entry = "command",
                                         .signals = {"white, all=1 mm", "\\µ\n"},
                                         .period = 0.1,
                                         .level = {1.0 / 7.0, 0.0, 3.0, 4.0, 5.0, 6.0}},
      .controller = "space=pose",
      .sensors = {{"acceleration -z", {0.1, 0.2, 0.3}, {0.0, 0.0, -1.0}}},
      .seed = 18446744073709551615U,
      .others = R"({"logger":{"serial":[1,2.5,null]}})"};
  return header;
}

/// Numbers of all sizes, with the ones that formats lose first: −0, tiny, huge, missing.
inline data::Record sample_record(Eigen::Index samples) {
  data::Record record{sample_header(), {}};
  record.samples.resize(samples, static_cast<Eigen::Index>(record.header.channels.size()));
  Random random(20261120);
  for (Eigen::Index i = 0; i < record.samples.size(); ++i)
    record.samples.data()[i] =
        random.uniform(-1.0, 1.0) * std::pow(10.0, random.uniform(-9.0, 9.0));
  const double special[] = {-0.0,
                            std::numeric_limits<double>::denorm_min(),
                            std::numeric_limits<double>::max(),
                            -std::numeric_limits<double>::min(),
                            std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            0.1};
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(record.samples.size(), 7); ++i)
    record.samples.data()[record.samples.size() - 1 - i] = special[i];
  return record;
}

/// Lists of equal length whose items have the same in each of these members.
template <class Item, class... Members>
void expect_same_items(const std::vector<Item>& a, const std::vector<Item>& b, Members... members) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    int number = 0;
    const auto compare = [&](auto member) {
      EXPECT_EQ(a[k].*member, b[k].*member) << "item " << k << ", member " << number++;
    };
    (compare(members), ...);
  }
}

inline void expect_same_geometry(const data::Geometry& a, const data::Geometry& b) {
  using data::Node;
  using data::TraceLine;
  expect_same_items(a.nodes, b.nodes, &Node::number, &Node::position, &Node::position_system,
                    &Node::motion_system, &Node::color);
  expect_same_items(a.lines, b.lines, &TraceLine::name, &TraceLine::nodes, &TraceLine::color);
}

inline void expect_same_header(const data::RecordHeader& a, const data::RecordHeader& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.sample_rate, b.sample_rate);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.date, b.date);
  EXPECT_EQ(a.repeat, b.repeat);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.experiment.machine, b.experiment.machine);
  EXPECT_EQ(data::experiment_json(a.experiment), data::experiment_json(b.experiment));
  expect_same_geometry(a.geometry, b.geometry);
  using data::Channel;
  expect_same_items(a.channels, b.channels, &Channel::name, &Channel::unit, &Channel::direction,
                    &Channel::role, &Channel::point, &Channel::entity, &Channel::id_lines);
}

}  // namespace hydrapod::test
