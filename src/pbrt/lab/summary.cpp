#include "pbrt/lab/summary.h"
