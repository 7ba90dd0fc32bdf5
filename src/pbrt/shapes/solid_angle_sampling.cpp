#include "pbrt/shapes/solid_angle_sampling.h"

namespace pbrt {

// Map of Urena, Fajardo and King 2013. With the eye at the origin, plane distance z, c = x / hypot(x, z) and b = y /
// hypot(y, z), the rectangle [0,x] x [0,y] has solid angle asin(c b). The part left of x in [y0,y1] is thus
//     g = asin(c b1) - asin(c b0), hence c = sin g / sqrt(b0^2 + b1^2 - 2 b0 b1 cos g).

SphericalRectangle::SphericalRectangle(const Point3 &eye, const Point3 &corner, const Vector3 &edgeX,
                                       const Vector3 &edgeY)
    : eye_(eye) {
    using D = glm::dvec3;
    D ex(edgeX), ey(edgeY), s = D(corner) - D(eye);
    double width = glm::length(ex), height = glm::length(ey);
    D x = ex / width, y = ey / height;
    axisX_ = Vector3(x);
    axisY_ = Vector3(y);
    x0_ = glm::dot(s, x);
    y0_ = glm::dot(s, y);
    x1_ = x0_ + width;
    y1_ = y0_ + height;
    z_ = std::abs(glm::dot(s, glm::cross(x, y)));
    b0_ = y0_ / std::sqrt(y0_ * y0_ + z_ * z_);
    b1_ = y1_ / std::sqrt(y1_ * y1_ + z_ * z_);
    left_ = AreaLeftOf(x0_);
    // An eye within rounding of the plane (a point of the rectangle) sees it edge-on, not as half the sphere.
    double rounding = 1e-6 * (double(MaxComponent(Abs(eye))) + width + height);
    area_ = z_ > rounding ? AreaLeftOf(x1_) - left_ : 0;
}

double SphericalRectangle::AreaLeftOf(double x) const {
    double c = x / std::sqrt(x * x + z_ * z_);
    return std::asin(c * b1_) - std::asin(c * b0_);
}

Point2 SphericalRectangle::Sample(const Point2 &u) const {
    double g = left_ + double(u.x) * area_;
    double denominator = std::sqrt(std::max(b0_ * b0_ + b1_ * b1_ - 2 * b0_ * b1_ * std::cos(g), 1e-300));
    double c = std::clamp(std::sin(g) / denominator, -1.0, 1.0);
    double x = std::clamp(c * z_ / std::sqrt(std::max(1 - c * c, 1e-300)), x0_, x1_);
    double d2 = x * x + z_ * z_;
    double h0 = y0_ / std::sqrt(y0_ * y0_ + d2), h1 = y1_ / std::sqrt(y1_ * y1_ + d2);
    double h = h0 + double(u.y) * (h1 - h0);
    double y = std::clamp(h * std::sqrt(d2 / std::max(1 - h * h, 1e-300)), y0_, y1_);
    return {Float((x - x0_) / (x1_ - x0_)), Float((y - y0_) / (y1_ - y0_))};
}

Point2 SphericalRectangle::Invert(const Point3 &p) const {
    glm::dvec3 s = glm::dvec3(p) - glm::dvec3(eye_);
    double x = std::clamp(glm::dot(s, glm::dvec3(axisX_)), x0_, x1_);
    double y = std::clamp(glm::dot(s, glm::dvec3(axisY_)), y0_, y1_);
    double d2 = x * x + z_ * z_;
    double h0 = y0_ / std::sqrt(y0_ * y0_ + d2), h1 = y1_ / std::sqrt(y1_ * y1_ + d2), h = y / std::sqrt(y * y + d2);
    auto unit = [](double v) { return Float(std::clamp(v, 0.0, 1.0)); };
    return {unit((AreaLeftOf(x) - left_) / area_), unit((h - h0) / (h1 - h0))};
}

struct TriangleSampling::InDouble {
    glm::dvec3 to[3], distance;
    SphericalTriangleOf<double> sphere;

    explicit InDouble(const View &s) {
        const glm::dvec3 from(s.from);
        const Point3 corners[] = {s.p0, s.p1, s.p2};
        for (int i = 0; i < 3; ++i) {
            to[i] = glm::dvec3(corners[i]) - from;
            distance[i] = glm::length(to[i]);
        }
        sphere = {to[0] / distance[0], to[1] / distance[1], to[2] / distance[2]};
    }
};

double TriangleSampling::AreaInDouble(View view) { return InDouble(view).sphere.Area(); }

TriangleSampling::Point TriangleSampling::SampleInDouble(View view, Point2 square, Float squarePdf) {
    const InDouble triangle(view);
    glm::dvec3 b = triangle.sphere.Sample(square) / triangle.distance;
    b /= b.x + b.y + b.z;
    const glm::dvec3 offset = b.x * triangle.to[0] + b.y * triangle.to[1] + b.z * triangle.to[2];
    return {Vector3(b), squarePdf / Float(triangle.sphere.Area()), Vector3(offset)};
}

Point2 TriangleSampling::InvertInDouble(View view, Vector3 wi, Float *area) {
    const InDouble triangle(view);
    const glm::dvec3 w = glm::normalize(glm::dvec3(wi));
    *area = Float(triangle.sphere.Area());
    return triangle.sphere.Invert(triangle.sphere.WeightsOf(w), w);
}

}  // namespace pbrt
