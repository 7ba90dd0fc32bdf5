#include "pbrt/lab/convergence.h"
