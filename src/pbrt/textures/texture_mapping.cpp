#include "pbrt/textures/texture_mapping.h"

namespace pbrt {
namespace {

/// Gradient of azimuth / 2 pi; 0 on the axis, where it is undefined.
Vector3 AzimuthGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y);
    if (!(r2 > 0)) return Vector3(0);
    return Vector3(-p.y, p.x, 0) * (Inv2Pi / r2);
}

/// Gradient of polar angle / pi; 0 on the axis.
Vector3 PolarGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y), r = std::sqrt(r2);
    if (!(r > 0)) return Vector3(0);
    return Vector3(p.x * p.z / r, p.y * p.z / r, -r) * (InvPi / (r2 + Sqr(p.z)));
}

}  // namespace

TexCoord2 SphericalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Float distance = Length(c.p);
    Float theta = distance > 0 ? SafeACos(c.p.z / distance) : 0;
    Float phi = std::atan2(c.p.y, c.p.x);
    if (phi < 0) phi += 2 * Pi;
    // As in stock pbrt-v4, the derivatives are swapped: the azimuth's is returned for s, the polar angle's for t. It
    // affects only filter widths.
    Vector3 ds = AzimuthGradient(c.p), dt = PolarGradient(c.p);
    return {{theta * InvPi, phi * Inv2Pi}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), Dot(dt, c.dpdx), Dot(dt, c.dpdy)};
}

TexCoord2 CylindricalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Vector3 ds = AzimuthGradient(c.p);
    return {{(Pi + std::atan2(c.p.y, c.p.x)) * Inv2Pi, c.p.z}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), c.dpdx.z, c.dpdy.z};
}

TexCoord2 PlanarMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    return {{du + Dot(c.p, vs), dv + Dot(c.p, vt)}, Dot(vs, c.dpdx), Dot(vs, c.dpdy), Dot(vt, c.dpdx), Dot(vt, c.dpdy)};
}

TextureMapping2D MappingParams::Make(const ParamSet &set, const Transform &renderFromTexture,
                                     DiagnosticSink &sink) const {
    if (mapping != "uv" && renderFromTexture.IsSingular())
        throw set.Error("", "mapping \"{}\" needs a transformation that can be inverted.", mapping);
    if (mapping == "spherical") return SphericalMapping{PointMapping(renderFromTexture)};
    if (mapping == "cylindrical") return CylindricalMapping{PointMapping(renderFromTexture)};
    if (mapping == "planar") return PlanarMapping{PointMapping(renderFromTexture), v1, v2, uv.du, uv.dv};
    if (mapping != "uv")
        set.Warn(sink, "mapping",
                 fmt::format("unknown mapping \"{}\", \"uv\" is used; {}.", mapping,
                             ListChoices(mapping, {"uv", "spherical", "cylindrical", "planar"})));
    return uv;
}

}  // namespace pbrt
