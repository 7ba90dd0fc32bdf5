#pragma once
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/math/ray.h"
#include "pbrt/media/majorant_grid.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// What a medium does at a place, at the wavelengths of a path. Absorption and scattering are per unit of length in
/// rendering space, which is that of the world.
struct MediumCoefficients {
    SampledSpectrum absorption, scattering;
    SampledSpectrum emission;  ///< radiance; the medium emits absorption * emission per unit of length
};

/// A stretch of a ray in which the coefficients of absorption and scattering together are at most `majorant`.
struct MajorantSegment {
    Float begin = 0, end = 0;  ///< distances along the ray; `end` may be infinite
    SampledSpectrum majorant;  ///< per unit of length; not 0 at all wavelengths
};

class MediumOnRay;

/// Something that absorbs, scatters or emits light between surfaces. Immutable, shared between threads.
class Medium {
  public:
    virtual ~Medium() = default;
    const HenyeyGreenstein &Phase() const { return phase_; }
    bool IsEmissive() const { return isEmissive_; }
    /// Memory that the medium takes.
    virtual size_t Bytes() const = 0;

    /// The medium along a ray, whose direction must have unit length, from its origin to the distance tMax, which may
    /// be infinite. Refers to the medium.
    virtual MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const = 0;
    /// The coefficients at a place of rendering space. Slower than MediumOnRay::At.
    MediumCoefficients At(const Point3 &p, const SampledWavelengths &lambda) const;

  protected:
    Medium(Float g, bool isEmissive) : phase_(g), isEmissive_(isEmissive) {}

  private:
    friend class MediumOnRay;
    /// The coefficients at a distance that the walk of the ray contains.
    virtual MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const = 0;

    HenyeyGreenstein phase_;
    bool isEmissive_;
};

/// A medium along one ray: first where collisions can happen, then what the medium does at the distances chosen. A
/// value without memory of its own that is made for every ray; one thread uses it.
class MediumOnRay {
  public:
    /// The next stretch of the ray; they come in order of distance, within [0, tMax], and none is empty. Between them
    /// is vacuum. False if there are no more.
    bool Next(MajorantSegment *segment) {
        Float value = 0;
        if (!majorant_ || !walk_.Next(&segment->begin, &segment->end, &value)) return false;
        segment->majorant = majorant_ * value;
        return true;
    }
    /// The coefficients at a distance along the ray. In the stretch that Next returned last they keep to its majorant.
    MediumCoefficients At(Float t) {
        if (!walk_.Contains(t)) return {};
        return medium_->Evaluate(*this, t);
    }

    // For the classes of media.

    /// `unit`: the coefficients at density 1, as far as they do not depend on the place. `majorant` is multiplied by
    /// the values of the walk.
    MediumOnRay(const Medium &medium, const GridWalk &walk, const SampledWavelengths &lambda,
                const MediumCoefficients &unit, const SampledSpectrum &majorant)
        : medium_(&medium), walk_(walk), lambda_(lambda), unit_(unit), majorant_(majorant) {}

    const GridWalk &Walk() const { return walk_; }
    const SampledWavelengths &Lambda() const { return lambda_; }
    const MediumCoefficients &Unit() const { return unit_; }
    /// Memory for what a class of media keeps along a ray. It must be made before it is used.
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

}  // namespace pbrt
