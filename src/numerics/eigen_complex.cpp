#include "eigen_instances.hpp"

HYDRAPOD_EIGEN_COMPLEX(template)
