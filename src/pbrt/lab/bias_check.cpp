#include "pbrt/lab/bias_check.h"
