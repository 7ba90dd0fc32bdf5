#include "pbrt/lab/tile_statistics.h"
