#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/textures/texture_factory.h"
#include "support/errors.h"

namespace pbrt::test {

/// A location for messages: column `column` of line `line` of a made-up file.
inline FileLoc At(int line, int column = 0) {
    static const auto file = std::make_shared<const SourceFile>(SourceFile{"scene.pbrt", std::string(200, '\n')});
    return {file, line, column};
}

/// Builds parameter lists: Params("what").F("scale", 2).Tex("tex", "name").
class Params {
  public:
    explicit Params(const std::string &what = "test", int line = 1) : set_(what, At(line)), line_(line) {}
    operator ParamSet() const { return set_; }
    const ParamSet &Set() const { return set_; }

    Params &F(const std::string &name, Float v) { return Floats(ParamType::Float, name, {v}); }
    Params &Rgb(const std::string &name, Float r, Float g, Float b) { return Floats(ParamType::Rgb, name, {r, g, b}); }
    Params &V3(const std::string &name, Float x, Float y, Float z) {
        return Floats(ParamType::Vector3, name, {x, y, z});
    }
    Params &Spectrum(const std::string &name, std::vector<Float> values) {
        return Floats(ParamType::Spectrum, name, std::move(values));
    }
    Params &NamedSpectrum(const std::string &name, const std::string &v) {
        return Strings(ParamType::Spectrum, name, {v});
    }
    Params &Tex(const std::string &name, const std::string &v) { return Strings(ParamType::Texture, name, {v}); }
    Params &S(const std::string &name, std::vector<std::string> v) {
        return Strings(ParamType::String, name, std::move(v));
    }
    Params &I(const std::string &name, int v) {
        Param p = New(ParamType::Integer, name);
        p.ints = {v};
        set_.Add(std::move(p));
        return *this;
    }
    Params &B(const std::string &name, bool v) {
        Param p = New(ParamType::Bool, name);
        p.bools = {v};
        set_.Add(std::move(p));
        return *this;
    }
    Params &Default(ParamType type, const std::string &name, std::vector<Float> v) {
        Param p = New(type, name);
        p.floats = std::move(v);
        set_.AddDefault(std::move(p));
        return *this;
    }

  private:
    /// Every parameter is on the next line, so that the line of a message tells which one is meant.
    Param New(ParamType type, const std::string &name) {
        Param p;
        p.type = type;
        p.name = name;
        p.loc = At(++line_);
        return p;
    }
    Params &Floats(ParamType type, const std::string &name, std::vector<Float> v) {
        Param p = New(type, name);
        p.floats = std::move(v);
        set_.Add(std::move(p));
        return *this;
    }
    Params &Strings(ParamType type, const std::string &name, std::vector<std::string> v) {
        Param p = New(type, name);
        p.strings = std::move(v);
        set_.Add(std::move(p));
        return *this;
    }
    ParamSet set_;
    int line_;
};

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
    FloatTexturePtr FloatTex(const std::string &name) { return GetFloat(Params("user").Tex("x", name), "x"); }
    SpectrumTexturePtr SpectrumTex(const std::string &name, SpectrumUse use = SpectrumUse::Albedo) {
        return GetSpectrum(Params("user").Tex("x", name), "x", use);
    }
    size_t Errors() const { return sink.ErrorCount(); }
    const Diagnostic &Last() const { return sink.All().back(); }
};

inline void ExpectNear(const SampledSpectrum &a, const SampledSpectrum &b, Float tolerance = 1e-5f) {
    for (int i = 0; i < SpectrumSamples; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

}  // namespace pbrt::test
