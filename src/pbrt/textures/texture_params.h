#pragma once
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {

/// A parameter that is a number or names a float texture. How it is declared and, after reading, what was given; valid
/// while the ParamSet lives. Of a number and a name the last one counts, and the other is unused.
struct FloatTextureParam {
    std::optional<Float> constant{};      ///< the default; nullopt: none
    std::optional<Range<Float>> range{};  ///< of a texture that is the same everywhere
    const ParamSet *set = nullptr;
    const Param *given = nullptr;

    explicit operator bool() const { return given != nullptr; }
};

/// The same for spectra.
struct SpectrumTextureParam : SpectrumParam {};

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value);
void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value, const Range<Float> &range);
void ReadParam(ParamReader &reader, const std::string &name, SpectrumTextureParam &value);
void DocumentParam(ParamDoc &doc, const FloatTextureParam &value);
void DocumentParam(ParamDoc &doc, const FloatTextureParam &value, const Range<Float> &range);
void DocumentParam(ParamDoc &doc, const SpectrumTextureParam &value);

}  // namespace pbrt
