#pragma once
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {

/// A number or named float texture: its declaration and, after reading, the given value. Valid while the ParamSet
/// lives. If both a number and a name are given, the last one is used, and the other is an unused parameter.
struct FloatTextureParam {
    std::optional<Float> constant{};      ///< default; nullopt: none
    std::optional<Range<Float>> range{};  ///< of numbers and constant textures
    const ParamSet *set = nullptr;
    const Param *given = nullptr;

    explicit operator bool() const { return given != nullptr; }
};

struct SpectrumTextureParam : SpectrumParam {};

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value);
void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value, const Range<Float> &range);
void ReadParam(ParamReader &reader, const std::string &name, SpectrumTextureParam &value);
void DocumentParam(ParamDoc &doc, const FloatTextureParam &value);
void DocumentParam(ParamDoc &doc, const FloatTextureParam &value, const Range<Float> &range);
void DocumentParam(ParamDoc &doc, const SpectrumTextureParam &value);

}  // namespace pbrt
