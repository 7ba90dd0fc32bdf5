#pragma once
#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// How an `rgb` parameter is uplifted (pbrt-v4-format §4).
enum class SpectrumUse { Albedo, Unbounded, Illuminant };

/// Reads a spectrum-valued parameter in any of its forms: rgb, blackbody, spectrum (inline samples, name, file).
/// `defaultValue` (may be null) if absent. Errors: negative rgb, albedo above 1, negative illuminant, odd or unsorted samples, unknown name
/// or unreadable file, several values where one is meant.
SpectrumPtr GetSpectrum(const ParamSet &params, std::string_view name, SpectrumPtr defaultValue, SpectrumUse use,
                        const FileResolver &files);

/// As GetSpectrum, but `"float name"` is accepted too (eta of dielectrics): constant.
SpectrumPtr GetSpectrumOrFloat(const ParamSet &params, std::string_view name, SpectrumPtr defaultValue, SpectrumUse use,
                               const FileResolver &files);

}  // namespace pbrt
