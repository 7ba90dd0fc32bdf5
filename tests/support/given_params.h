#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/math/vec.h"
#include "support/param.h"

namespace pbrt::test {

/// Parameters as a scene file would give them; line numbers count the parameters.
class Params {
  public:
    /// The directive is at line 100, the first parameter at line 1.
    explicit Params(std::string what = "Entity \"test\"") : Params(std::move(what), 100) { lines_ = 0; }
    /// The first parameter is at the line behind the directive's.
    Params(std::string what, int line)
        : file_(std::make_shared<SourceFile>(SourceFile{"test.pbrt", ""})), lines_(line),
          set_(std::move(what), Loc(line)) {}
    Params &Add(Param p) {
        p.loc = Loc(++lines_);
        set_.Add(std::move(p));
        return *this;
    }
    Params &Floats(ParamType type, const std::string &name, std::vector<Float> v) {
        return Add(FloatParam(name, std::move(v), type));
    }
    Params &Integer(const std::string &name, int v) { return Add(IntParam(name, v)); }
    Params &Integers(const std::string &name, std::vector<int> v) {
        Param p = IntParam(name, 0);
        p.ints = std::move(v);
        return Add(std::move(p));
    }
    /// As an Attribute directive gives it.
    Params &Default(ParamType type, const std::string &name, std::vector<Float> v) {
        return Default(FloatParam(name, std::move(v), type));
    }
    Params &Default(Param p) {
        p.loc = Loc(++lines_);
        set_.AddDefault(std::move(p));
        return *this;
    }
    Params &Number(const std::string &name, Float v) { return Floats(ParamType::Float, name, {v}); }
    Params &Point(const std::string &name, Point3 v) { return Floats(ParamType::Point3, name, {v.x, v.y, v.z}); }
    Params &Rgb(const std::string &name, Float r, Float g, Float b) { return Floats(ParamType::Rgb, name, {r, g, b}); }
    Params &Vector(const std::string &name, Float x, Float y, Float z) {
        return Floats(ParamType::Vector3, name, {x, y, z});
    }
    Params &Spectrum(const std::string &name, std::vector<Float> v) {
        return Floats(ParamType::Spectrum, name, std::move(v));
    }
    Params &NamedSpectrum(const std::string &name, const std::string &v) {
        return Add(StringParam(name, v, ParamType::Spectrum));
    }
    Params &Texture(const std::string &name, const std::string &v) {
        return Add(StringParam(name, v, ParamType::Texture));
    }
    Params &String(const std::string &name, const std::string &v) { return Add(StringParam(name, v)); }
    Params &Strings(const std::string &name, std::vector<std::string> v) {
        Param p = StringParam(name, "");
        p.strings = std::move(v);
        return Add(std::move(p));
    }
    Params &Bool(const std::string &name, bool v) { return Add(BoolParam(name, v)); }
    const ParamSet &Set() const { return set_; }
    operator const ParamSet &() const { return set_; }

  private:
    FileLoc Loc(int line) const { return {file_, line, 4}; }
    std::shared_ptr<SourceFile> file_;
    int lines_;
    ParamSet set_;
};

}  // namespace pbrt::test
