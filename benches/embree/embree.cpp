// The rival: Embree on one thread, asked one ray at a time, in its robust mode.
//
// usage: embree MESH RAYS...
//
// MESH: counts of vertices and triangles (u32), positions (3 f32), indices
// (3 u32). RAYS: one byte, 'c' closest hit or 'a' any hit, the count (u32), and
// for each ray origin, direction and limits (8 f32). For each file a line:
// nanoseconds of the fastest of its rounds, the number of hits, the sum of
// their distances. The first line is the time to build, in nanoseconds.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include <embree3/rtcore.h>

using Clock = std::chrono::steady_clock;

static double nanoseconds(Clock::time_point since) {
  return std::chrono::duration<double, std::nano>(Clock::now() - since).count();
}

template <typename T> static std::vector<T> read(std::ifstream &in, size_t count) {
  std::vector<T> data(count);
  in.read(reinterpret_cast<char *>(data.data()), std::streamsize(count * sizeof(T)));
  if (!in) {
    std::fprintf(stderr, "a file is shorter than it says\n");
    std::exit(1);
  }
  return data;
}

static RTCScene build(RTCDevice device, const char *path, double &time) {
  std::ifstream in(path, std::ios::binary);
  auto counts = read<uint32_t>(in, 2);
  auto positions = read<float>(in, size_t(counts[0]) * 3);
  auto indices = read<uint32_t>(in, size_t(counts[1]) * 3);
  auto start = Clock::now();
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto *v = static_cast<float *>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), counts[0]));
  std::copy(positions.begin(), positions.end(), v);
  auto *t = static_cast<uint32_t *>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), counts[1]));
  std::copy(indices.begin(), indices.end(), t);
  rtcCommitGeometry(mesh);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  rtcAttachGeometry(scene, mesh);
  rtcReleaseGeometry(mesh);
  rtcCommitScene(scene);
  time = nanoseconds(start);
  return scene;
}

int main(int argc, char **argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: embree MESH RAYS...\n");
    return 2;
  }
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  double time = 0;
  RTCScene scene = build(device, argv[1], time);
  std::printf("%.0f\n", time);
  for (int file = 2; file < argc; ++file) {
    std::ifstream in(argv[file], std::ios::binary);
    bool any = read<char>(in, 1)[0] == 'a';
    uint32_t count = read<uint32_t>(in, 1)[0];
    auto rays = read<float>(in, size_t(count) * 8);
    double best = INFINITY, sum = 0;
    uint64_t hits = 0;
    for (int round = 0; round < 7; ++round) {
      hits = 0;
      sum = 0;
      auto start = Clock::now();
      for (uint32_t i = 0; i < count; ++i) {
        const float *r = &rays[size_t(i) * 8];
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit h{};
        h.ray.org_x = r[0], h.ray.org_y = r[1], h.ray.org_z = r[2];
        h.ray.dir_x = r[3], h.ray.dir_y = r[4], h.ray.dir_z = r[5];
        h.ray.tnear = r[6], h.ray.tfar = r[7];
        h.ray.mask = ~0u;
        h.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (any) {
          rtcOccluded1(scene, &context, &h.ray);
          hits += h.ray.tfar < 0;
        } else {
          rtcIntersect1(scene, &context, &h);
          if (h.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            ++hits;
            sum += h.ray.tfar;
          }
        }
      }
      best = std::fmin(best, nanoseconds(start));
    }
    std::printf("%.0f %llu %.9g\n", best, static_cast<unsigned long long>(hits), sum);
  }
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
