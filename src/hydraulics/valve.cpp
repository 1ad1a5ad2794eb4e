#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

PortFlowSlopes valve_flow_slopes(const Valve& valve, double x, const PortPressures& p) {
  const double at = std::clamp(x, -1.0, 1.0);
  const bool inside = std::abs(x) < 1.0;
  const double open_forward = valve.gain * opening(valve, at);
  const double open_backward = valve.gain * opening(valve, -at);
  const double forward_x = inside ? valve.gain * opening_slope(valve, at) : 0.0;
  const double backward_x = inside ? -valve.gain * opening_slope(valve, -at) : 0.0;
  const double p_t = valve.laminar_pressure;
  PortFlowSlopes slopes;
  slopes.cap_x =
      forward_x * orifice(p.supply - p.cap, p_t) - backward_x * orifice(p.cap - p.back, p_t);
  slopes.rod_x =
      backward_x * orifice(p.supply - p.rod, p_t) - forward_x * orifice(p.rod - p.back, p_t);
  slopes.cap_p = -open_forward * orifice_slope(p.supply - p.cap, p_t) -
                 open_backward * orifice_slope(p.cap - p.back, p_t);
  slopes.rod_p = -open_backward * orifice_slope(p.supply - p.rod, p_t) -
                 open_forward * orifice_slope(p.rod - p.back, p_t);
  return slopes;
}

double null_leakage(const Valve& valve, double supply, double back) {
  return 2.0 * valve.gain * opening(valve, 0.0) *
         orifice(0.5 * (supply - back), valve.laminar_pressure);
}

}  // namespace hydrapod::hydraulics
