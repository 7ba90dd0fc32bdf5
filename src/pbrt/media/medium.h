#pragma once
#include <cstddef>
#include <new>
#include <type_traits>

#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/math/ray.h"
#include "pbrt/media/majorant_grid.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Medium properties at a point, at one path's wavelengths. Absorption and scattering per unit length in rendering
/// space (= world space units).
struct MediumCoefficients {
    SampledSpectrum absorption, scattering;
    SampledSpectrum emission;  ///< radiance; absorption * emission is emitted per unit length
};

/// Ray segment in which absorption plus scattering is at most `majorant`.
struct MajorantSegment {
    Float begin = 0, end = 0;  ///< distances along the ray; `end` may be infinite
    SampledSpectrum majorant;  ///< per unit length; not 0 at all wavelengths
};

class MediumOnRay;

/// Participating medium. Immutable and thread-safe.
class Medium {
  public:
    virtual ~Medium() = default;
    const HenyeyGreenstein &Phase() const { return phase_; }
    bool IsEmissive() const { return isEmissive_; }
    virtual size_t Bytes() const = 0;

    /// The medium along a ray of unit direction up to distance tMax, which may be infinite. Refers to this medium.
    virtual MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const = 0;
    /// Coefficients at a point in rendering space. Slower than MediumOnRay::At.
    MediumCoefficients At(const Point3 &p, const SampledWavelengths &lambda) const;

  protected:
    Medium(Float g, bool isEmissive) : phase_(g), isEmissive_(isEmissive) {}

  private:
    friend class MediumOnRay;
    virtual MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const = 0;

    HenyeyGreenstein phase_;
    bool isEmissive_;
};

/// Medium along one ray: majorant segments, then coefficients at sampled distances. Created per ray without allocation;
/// not thread-safe.
class MediumOnRay {
  public:
    /// Next segment within [0, tMax]; segments are in order and never empty, with vacuum between them. False if there
    /// are no more.
    bool Next(MajorantSegment *segment) {
        Float value = 0;
        if (!majorant_ || !walk_.Next(&segment->begin, &segment->end, &value)) return false;
        segment->majorant = majorant_ * value;
        return true;
    }
    /// Coefficients at a distance. In the last segment of Next they do not exceed its majorant.
    MediumCoefficients At(Float t) {
        if (!walk_.Contains(t)) return {};
        return medium_->Evaluate(*this, t);
    }

    /// `unit`: coefficients at density 1, as far as they are constant. `majorant` is multiplied by the values of the
    /// walk.
    MediumOnRay(const Medium &medium, const GridWalk &walk, const SampledWavelengths &lambda,
                const MediumCoefficients &unit, const SampledSpectrum &majorant)
        : medium_(&medium), walk_(walk), lambda_(lambda), unit_(unit), majorant_(majorant) {}

    const GridWalk &Walk() const { return walk_; }
    const SampledWavelengths &Lambda() const { return lambda_; }
    const MediumCoefficients &Unit() const { return unit_; }
    /// Storage for per-ray state of derived media. Must be constructed before use.
    template <class T>
    T &MakeMemory(const T &value) {
        static_assert(sizeof(T) <= sizeof(memory_) && alignof(T) <= 16 && std::is_trivially_copyable_v<T>);
        return *new (memory_) T(value);
    }
    template <class T>
    T &Memory() {
        return *std::launder(reinterpret_cast<T *>(memory_));
    }

  private:
    const Medium *medium_;
    GridWalk walk_;
    SampledWavelengths lambda_;
    MediumCoefficients unit_;
    SampledSpectrum majorant_;
    alignas(16) std::byte memory_[192];
};

inline MediumCoefficients Medium::At(const Point3 &p, const SampledWavelengths &lambda) const {
    return On({.o = p}, 0, lambda).At(0);
}

}  // namespace pbrt
