#include "pbrt/media/medium.h"

namespace pbrt {

MediumCoefficients Medium::At(const Point3 &p, const SampledWavelengths &lambda) const {
    Ray ray;
    ray.o = p;
    return On(ray, 0, lambda).At(0);
}

}  // namespace pbrt
