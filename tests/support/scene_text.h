#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <string>

// Scenes of tests as pbrt text. In every argument ' stands for ", as in "'float fov' 60".
namespace pbrt::test {

inline std::string Quoted(std::string text) {
    std::replace(text.begin(), text.end(), '\'', '"');
    return text;
}
/// The same as whole lines; nothing if the text is empty.
inline std::string QuotedLines(const std::string &text) {
    return text.empty() || text.back() == '\n' ? Quoted(text) : Quoted(text) + "\n";
}

/// Directives of the world, in the order of the calls. Points and colours are numbers without brackets.
class Objects {
  public:
    /// Any directives.
    Objects &Add(const std::string &text) {
        text_ += QuotedLines(text);
        return *this;
    }
    Objects &Light(const std::string &type, const std::string &parameters = "") {
        return Add("LightSource '" + type + "' " + parameters);
    }
    Objects &PointLight(const std::string &from, const std::string &intensity) {
        return Light("point", "'point3 from' [ " + from + " ] 'rgb I' [ " + intensity + " ]");
    }
    Objects &Sky(const std::string &radiance) { return Light("infinite", "'rgb L' [ " + radiance + " ]"); }
    /// The shapes that follow emit.
    Objects &AreaLight(const std::string &radiance, const std::string &parameters = "") {
        return Add("AreaLightSource 'diffuse' 'rgb L' [ " + radiance + " ] " + parameters);
    }
    Objects &Material(const std::string &type, const std::string &parameters = "") {
        return Add("Material '" + type + "' " + parameters);
    }
    Objects &Diffuse(const std::string &reflectance) {
        return Material("diffuse", "'rgb reflectance' [ " + reflectance + " ]");
    }
    Objects &Shape(const std::string &type, const std::string &parameters = "") {
        return Add("Shape '" + type + "' " + parameters);
    }
    Objects &Sphere(double radius = 1) { return Shape("sphere", fmt::format("'float radius' {}", radius)); }
    Objects &Disk(double radius) { return Shape("disk", fmt::format("'float radius' {}", radius)); }
    /// A bilinear patch: p(0, 0), p(1, 0), p(0, 1), p(1, 1).
    Objects &Quad(const std::string &corners) { return Shape("bilinearmesh", "'point3 P' [ " + corners + " ]"); }
    /// Two triangles by default, of four corners in circular order.
    Objects &Triangles(const std::string &points, const std::string &indices = "0 1 2  0 2 3") {
        return Shape("trianglemesh", "'point3 P' [ " + points + " ] 'integer indices' [ " + indices + " ]");
    }
    /// The objects between AttributeBegin and AttributeEnd; `before`: directives before them, such as transformations.
    Objects &Attribute(const std::string &before, const Objects &inner) {
        return Add("AttributeBegin " + before + "\n" + inner.text_ + "AttributeEnd");
    }
    operator const std::string &() const { return text_; }

  private:
    std::string text_;
};

/// The sides of a room of 6 x 2 x 6, as corners of quads; cameras stand at its front wall.
namespace room {
inline constexpr const char *kFloor = "-3 0 -3  3 0 -3  -3 0 3  3 0 3", *kCeiling = "-3 2 -3  3 2 -3  -3 2 3  3 2 3",
                            *kFront = "-3 0 -3  3 0 -3  -3 2 -3  3 2 -3", *kBack = "-3 0 3  3 0 3  -3 2 3  3 2 3",
                            *kLeft = "-3 0 -3  -3 0 3  -3 2 -3  -3 2 3", *kRight = "3 0 -3  3 0 3  3 2 -3  3 2 3";
}  // namespace room

/// A floor at -y and a ceiling at y, open at the sides, around the origin.
inline Objects FloorAndCeiling(double x, double y, double z) {
    const auto level = [&](double height) {
        return fmt::format("{0} {4} {2}  {1} {4} {2}  {0} {4} {3}  {1} {4} {3}", -x, x, -z, z, height);
    };
    return Objects().Material("diffuse").Quad(level(-y)).Quad(level(y));
}

/// A whole scene: the directives before the world in the order of the calls, then the world. What is not called is not
/// in the text, so pbrt's defaults hold.
class SceneText {
  public:
    /// Any directives, such as options, media and transformations.
    SceneText &Head(const std::string &text) {
        text_ += QuotedLines(text);
        return *this;
    }
    /// Rendering space is world space.
    SceneText &InWorldSpace() { return Head("Option 'rendercoordsys' 'world'"); }
    SceneText &LookAt(const std::string &eyeTargetUp) { return Head("LookAt " + eyeTargetUp); }
    /// A perspective camera.
    SceneText &Camera(double fov) { return Camera("perspective", fmt::format("'float fov' {}", fov)); }
    SceneText &Camera(const std::string &type, const std::string &parameters = "") {
        return Head("Camera '" + type + "' " + parameters);
    }
    SceneText &Film(int width, int height, const std::string &parameters = "", const std::string &type = "rgb") {
        return Head(fmt::format("Film '{}' 'integer xresolution' {} 'integer yresolution' {} {}", type, width, height,
                                parameters));
    }
    SceneText &Filter(const std::string &type) { return Head("PixelFilter '" + type + "'"); }
    /// The independent sampler.
    SceneText &Samples(int perPixel, const std::string &parameters = "") {
        return Head(fmt::format("Sampler 'independent' 'integer pixelsamples' {} {}", perPixel, parameters));
    }
    SceneText &Integrator(const std::string &name, const std::string &parameters = "") {
        return Head("Integrator '" + name + "' " + parameters);
    }
    SceneText &Integrator(const std::string &name, int maxDepth, const std::string &parameters = "") {
        return Integrator(name, fmt::format("'integer maxdepth' {} {}", maxDepth, parameters));
    }
    std::string World(const std::string &objects = "") const { return text_ + "WorldBegin\n" + Quoted(objects); }

  private:
    std::string text_;
};

}  // namespace pbrt::test
