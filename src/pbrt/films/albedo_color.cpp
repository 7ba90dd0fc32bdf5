#include "pbrt/films/visible_surface.h"

namespace pbrt {

Rgb AlbedoColor(const VisibleSurface &visible, const ColorSpace &space) {
    const SampledWavelengths &lambda = visible.lambda;
    const SampledSpectrum reflected = SafeDivide(visible.albedo * space.Illuminant().Sample(lambda), lambda.Pdf());
    const Xyz xyz((reflected * CieX().Sample(lambda)).Average(), (reflected * CieY().Sample(lambda)).Average(),
                  (reflected * CieZ().Sample(lambda)).Average());
    return space.ToRgb(xyz / CieYIntegral);
}

}  // namespace pbrt
