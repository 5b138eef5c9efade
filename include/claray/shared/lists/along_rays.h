// The list of what goes along with a ray from one surface to the next, besides its time. The members of PathSegment and
// of Sight, and the arrays of RayQueue are made from it.
#ifndef CLARAY_SHARED_LISTS_ALONG_RAYS_H
#define CLARAY_SHARED_LISTS_ALONG_RAYS_H

// A row is X(name, type, words, TAKEN): a member of PathSegment, its type and its size in 32-bit words. TAKEN is a
// macro of the kernels: whether surfaces set it and rays read it. It stands for that of an effect, which is not named
// here: programs that name an effect's macro are compiled for each scene. An even number of words keeps the arrays of
// queues aligned.
//   cone   where the ray begins; of a camera ray: camera_cone
//   media  that the ray is in (kernels/shade/media.clh); of a camera ray: none
// clang-format off
/// What the denoiser's guides take along, too. They see maps by the cones of camera rays.
#define CLARAY_ALONG_SIGHTS(X) \
    X(media, ulong, 2, TAKES_MEDIA)
#define CLARAY_ALONG_RAYS(X)    \
    X(cone, RayCone, 2, TAKES_CONE) \
    CLARAY_ALONG_SIGHTS(X)
// clang-format on

#endif
