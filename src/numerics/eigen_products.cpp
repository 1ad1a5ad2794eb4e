#include "eigen_instances.hpp"

HYDRAPOD_EIGEN_PRODUCTS(template)
