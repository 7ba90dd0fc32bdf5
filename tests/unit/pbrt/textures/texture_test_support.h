#pragma once
#include <gtest/gtest.h>

#include "pbrt/textures/texture_factory.h"
#include "support/errors.h"
#include "support/given_params.h"

namespace pbrt::test {

/// A texture that rises along u.
inline Params Ramp(Float low = 0, Float high = 1) {
    return Params().Number("v00", low).Number("v01", low).Number("v10", high).Number("v11", high);
}

/// A texture library with the objects that it needs.
struct Bench {
    DiagnosticSink sink;
    FileResolver files;
    TextureLibrary textures{files, sink};

    void Define(const std::string &name, bool isSpectrum, const std::string &type, const Params &params,
                const Transform &renderFromTexture = {}) {
        textures.Define(name, isSpectrum, type, params, renderFromTexture);
    }
    /// Gets a texture like a material that has only this parameter.
    template <class Param>
    auto Get(const ParamSet &set, const std::string &name, Param param) {
        ParamReader reader(set);
        reader(name, param, "");
        reader.Finish(sink);
        return textures.Get(param);
    }
    FloatTexturePtr GetFloat(const ParamSet &set, const std::string &name, std::optional<Float> defaultValue = {}) {
        return Get(set, name, FloatTextureParam{defaultValue});
    }
    SpectrumTexturePtr GetSpectrum(const ParamSet &set, const std::string &name, SpectrumUse use) {
        return Get(set, name, SpectrumTextureParam{{use}});
    }
    FloatTexturePtr FloatTex(const std::string &name) { return GetFloat(Params().Texture("x", name), "x"); }
    SpectrumTexturePtr SpectrumTex(const std::string &name, SpectrumUse use = SpectrumUse::Albedo) {
        return GetSpectrum(Params().Texture("x", name), "x", use);
    }
    size_t Errors() const { return sink.ErrorCount(); }
    /// Expects errors at these lines and no others; `words`: of the first.
    void ExpectErrors(const std::vector<int> &lines, const std::vector<std::string> &words = {}) const {
        std::vector<int> found;
        for (const Diagnostic &d : sink.All())
            if (d.severity == Severity::Error) found.push_back(d.loc.line);
        EXPECT_EQ(found, lines);
        if (!found.empty()) ExpectWords(sink.All()[0].message, words);
    }
    const Diagnostic &Last() const { return sink.All().back(); }
};

inline void ExpectNear(const SampledSpectrum &a, const SampledSpectrum &b, Float tolerance = 1e-5f) {
    for (int i = 0; i < SpectrumSamples; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

}  // namespace pbrt::test
