/// Loads SDF files with sdformat, the parser of Gazebo.
///
///     sdf_check FILE…
///
/// Says what the parser says, then the links, joints and the degrees of freedom of the open tree;
/// exit code 1 where there is an error.

#include <cstdio>
#include <sdf/sdf.hh>

int main(int count, char** arguments) {
  bool good = count > 1;
  for (int k = 1; k < count; ++k) {
    sdf::Root root;
    const auto errors = root.Load(arguments[k]);
    for (const auto& error : errors) std::fprintf(stderr, "%s\n", error.Message().c_str());
    good = good && errors.empty() && root.WorldCount() == 1;
    if (!good) continue;
    const auto* model = root.WorldByIndex(0)->ModelByIndex(0);
    double mass = 0.0;
    int visuals = 0, axes = 0;
    for (uint64_t i = 0; i < model->LinkCount(); ++i) {
      mass += model->LinkByIndex(i)->Inertial().MassMatrix().Mass();
      visuals += static_cast<int>(model->LinkByIndex(i)->VisualCount());
    }
    for (uint64_t i = 0; i < model->JointCount(); ++i)
      for (const unsigned axis : {0U, 1U})
        if (model->JointByIndex(i)->Axis(axis) != nullptr) ++axes;
    std::printf("links %d joints %d axes %d visuals %d mass %.12g\n",
                static_cast<int>(model->LinkCount()), static_cast<int>(model->JointCount()), axes,
                visuals, mass);
  }
  return good ? 0 : 1;
}
