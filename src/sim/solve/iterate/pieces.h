#pragma once

namespace obscura::sim {

// How much of a loop one thread takes at a time: some microseconds' worth. Loops of less are one thread's.
inline constexpr int kBodyPiece = 64;         // poses, bounds, velocities
inline constexpr int kPairPiece = 16;         // bodies, for whose pairs features are sought
inline constexpr int kTouchPiece = 256;       // contacts
inline constexpr int kBatchPiece = 8;         // four pairs side by side, in space and
inline constexpr int kPlaneBatchPiece = 24;   // in the plane;
inline constexpr int kActiveBatchPiece = 48;  // of these few are active

}  // namespace obscura::sim
