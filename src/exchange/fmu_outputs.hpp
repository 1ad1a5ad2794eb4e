#pragma once
/// The outputs of an FMU as a table, and the parts of the plant that a number may depend on.

#include "fmu_interface.hpp"
#include "hydrapod/rig/rig.hpp"

namespace hydrapod::exchange {

/// Groups of states and inputs. What legs have counts for one leg, or for all of them.
namespace part {
inline constexpr unsigned own_coordinate = 1U << 0U;  ///< x, y or z of the mass centre
inline constexpr unsigned position = 1U << 1U;        ///< all three
inline constexpr unsigned orientation = 1U << 2U;
inline constexpr unsigned flexible = 1U << 3U;
inline constexpr unsigned velocity = 1U << 4U;
inline constexpr unsigned turning = 1U << 5U;
inline constexpr unsigned flexible_rate = 1U << 6U;
inline constexpr unsigned pressure = 1U << 7U;
inline constexpr unsigned spool = 1U << 8U;
inline constexpr unsigned spool_rate = 1U << 9U;
inline constexpr unsigned supply = 1U << 10U;
inline constexpr unsigned bristle = 1U << 11U;
inline constexpr unsigned base = 1U << 12U;
inline constexpr unsigned base_rate = 1U << 13U;
inline constexpr unsigned valve = 1U << 14U;  ///< command, also of an electric drive
inline constexpr unsigned axial = 1U << 15U;  ///< force
inline constexpr unsigned wrench = 1U << 16U;
inline constexpr unsigned inflow = 1U << 17U;   ///< into the chambers: of valves or lines
inline constexpr unsigned arms = 1U << 18U;     ///< of elastomers, with what says how soft they are
inline constexpr unsigned payload = 1U << 19U;  ///< its modes, with their rates
inline constexpr unsigned nut = 1U << 20U;      ///< its way
inline constexpr unsigned nut_rate = 1U << 21U;
inline constexpr unsigned torque_integral = 1U << 22U;
inline constexpr unsigned joints = 1U << 23U;  ///< bend of their bristles
}  // namespace part

struct FmuOutput {
  std::string name{}, unit{}, description{};
  double nominal{};
  double (*get)(const simulation::PlantOutput&, int element){};  ///< null: of `sensor`
  int element{};                                                 ///< direction or leg
  int leg{-1};                                                   ///< whose parts; −1: of all
  unsigned parts{};                                              ///< on which it depends
  std::optional<rig::Accelerometer> sensor{};
};

std::vector<FmuOutput> fmu_output_table(const simulation::Plant& plant);

/// Parts on which accelerations depend, the torque of a motor, the speed of a piston, its position.
unsigned fmu_acceleration_parts();
unsigned fmu_torque_parts();
unsigned fmu_speed_parts();
unsigned fmu_stretch_parts();

}  // namespace hydrapod::exchange
