#include "eigen_instances.hpp"

HYDRAPOD_EIGEN_REAL(template)
