#pragma once
#include <cstdint>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

enum class TransportMode { Radiance, Importance };

enum class ReflTransFlags : uint8_t { None = 0, Reflection = 1, Transmission = 2, All = 3 };
constexpr bool Has(ReflTransFlags f, ReflTransFlags bit) { return (int(f) & int(bit)) != 0; }

enum class BxdfFlags : uint8_t { None = 0, Reflection = 1, Transmission = 2, Diffuse = 4, Glossy = 8, Specular = 16 };
constexpr BxdfFlags operator|(BxdfFlags a, BxdfFlags b) { return static_cast<BxdfFlags>(int(a) | int(b)); }
constexpr bool Has(BxdfFlags f, BxdfFlags bit) { return (int(f) & int(bit)) != 0; }
constexpr bool IsReflective(BxdfFlags f) { return Has(f, BxdfFlags::Reflection); }
constexpr bool IsTransmissive(BxdfFlags f) { return Has(f, BxdfFlags::Transmission); }
constexpr bool IsSpecular(BxdfFlags f) { return Has(f, BxdfFlags::Specular); }
constexpr bool IsNonSpecular(BxdfFlags f) { return Has(f, BxdfFlags::Diffuse | BxdfFlags::Glossy); }

/// Direction sampled from a BSDF, in the caller's space. `pdf` is by solid angle; for specular samples it is a discrete
/// probability, and f is the delta's weight divided by |cos|.
struct BsdfSample {
    SampledSpectrum f;
    Vector3 wi{};
    Float pdf = 0;
    BxdfFlags flags = BxdfFlags::None;
    Float eta = 1;                   ///< relative index of refraction along wi, 1 unless transmitted
    bool pdfIsProportional = false;  ///< f and pdf are stochastic, only their ratio is meaningful: for MIS call Pdf()
};

}  // namespace pbrt
