#pragma once
#include <variant>

#include "pbrt/core/param_reader.h"
#include "pbrt/math/transform.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Texture coordinates and their derivatives per pixel step in x and y.
struct TexCoord2 {
    Point2 st{};
    Float dsdx = 0, dsdy = 0, dtdx = 0, dtdy = 0;
};
/// Position in texture space and its derivatives per pixel step.
struct TexCoord3 {
    Point3 p{};
    Vector3 dpdx{}, dpdy{};
};

/// (su u + du, sv v + dv) of the surface's coordinates.
struct UvMapping {
    Float su = 1, sv = 1, du = 0, dv = 0;
    TexCoord2 Map(const TextureContext &ctx) const {
        return {{su * ctx.uv.x + du, sv * ctx.uv.y + dv}, su * ctx.dudx, su * ctx.dudy, sv * ctx.dvdx, sv * ctx.dvdy};
    }
};

/// Position and derivatives in texture space, by an invertible transformation.
struct PointMapping {
    explicit PointMapping(const Transform &renderFromTexture) : textureFromRender(renderFromTexture.Inverse()) {}
    Transform textureFromRender;
    TexCoord3 Map(const TextureContext &ctx) const {
        return {textureFromRender.Point(ctx.p), textureFromRender.Vector(ctx.dpdx), textureFromRender.Vector(ctx.dpdy)};
    }
};

/// (theta / pi, phi / 2 pi) about the origin of texture space.
struct SphericalMapping {
    PointMapping point;
    TexCoord2 Map(const TextureContext &ctx) const;
};

/// ((pi + atan2(y, x)) / 2 pi, z).
struct CylindricalMapping {
    PointMapping point;
    TexCoord2 Map(const TextureContext &ctx) const;
};

/// (du + p.vs, dv + p.vt).
struct PlanarMapping {
    PointMapping point;
    Vector3 vs{1, 0, 0}, vt{0, 1, 0};
    Float du = 0, dv = 0;
    TexCoord2 Map(const TextureContext &ctx) const;
};

using TextureMapping2D = std::variant<UvMapping, SphericalMapping, CylindricalMapping, PlanarMapping>;

inline TexCoord2 Map(const TextureMapping2D &mapping, const TextureContext &ctx) {
    if (const UvMapping *uv = std::get_if<UvMapping>(&mapping)) [[likely]]
        return uv->Map(ctx);
    return std::visit([&](const auto &m) { return m.Map(ctx); }, mapping);
}

/// Parameters of texture mapping (pbrt-v4-format §8).
struct MappingParams {
    std::string mapping = "uv";
    UvMapping uv;
    Vector3 v1{1, 0, 0}, v2{0, 1, 0};

    void Describe(auto &&v) {
        v("mapping", mapping, "uv, spherical, cylindrical or planar, else a warning");
        if (v.When(mapping == "uv")) {
            v("uscale", uv.su, "uv: factor of u");
            v("vscale", uv.sv, "uv: factor of v");
        }
        if (v.When(mapping == "uv" || mapping == "planar")) {
            v("udelta", uv.du, "uv, planar: offset of u");
            v("vdelta", uv.dv, "uv, planar: offset of v");
        }
        if (v.When(mapping == "planar")) {
            v("v1", v1, Items{ParamType::Vector3}, "planar: axis of u");
            v("v2", v2, Items{ParamType::Vector3}, "planar: axis of v");
        }
    }
    /// An unknown name is a warning and means "uv", as in stock pbrt-v4.
    TextureMapping2D Make(const ParamSet &set, const Transform &renderFromTexture, DiagnosticSink &sink) const;
};

/// Square wave (+1 on [0, 1), -1 on [1, 2), ...) filtered by a tent of half-width `radius` around x.
Float FilteredSquareWave(Float x, Float radius);

/// Weight of a checkerboard's second texture, in [0, 1]: 0 in the cell at the origin; filtered over the footprint.
Float CheckerWeight(const TextureMapping2D &mapping, const TextureContext &ctx);
Float CheckerWeight(const PointMapping &mapping, const TextureContext &ctx);

/// True in random dots of radius 0.35, in about 40 % of the unit cells around integer (s, t).
bool IsInDot(const Point2 &st);

/// Waves with height modulated by low-frequency noise.
Float WindyNoise(const TexCoord3 &c);

/// Colour of marble (sRGB) at t in [0, 1] of a vein's period.
Rgb MarbleColor(Float t);

}  // namespace pbrt
