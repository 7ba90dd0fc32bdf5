#include "pbrt/core/error.h"
#include "pbrt/spectra/spectral_data.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

namespace {

DenseSpectrum MatchingFunction(size_t column) {
    const ThreeColumnTable &table = EmbeddedCie1931();
    PBRT_CHECK(table.lambdas.front() == LambdaMin && table.lambdas.back() == LambdaMax);
    return DenseSpectrum(table.columns[column]);
}

}  // namespace

const DenseSpectrum &CieX() {
    static const DenseSpectrum x = MatchingFunction(0);
    return x;
}
const DenseSpectrum &CieY() {
    static const DenseSpectrum y = MatchingFunction(1);
    return y;
}
const DenseSpectrum &CieZ() {
    static const DenseSpectrum z = MatchingFunction(2);
    return z;
}

Vector3 SpectrumToXyz(const Spectrum &s) {
    return Vector3(InnerProduct(CieX(), s), InnerProduct(CieY(), s), InnerProduct(CieZ(), s)) / CieYIntegral;
}

}  // namespace pbrt
