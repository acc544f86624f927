/** Which part of the hall a picture shows. Metres of the hall, y to the north; pixels of the picture, y downwards. */
export interface Point {
  x: number;
  y: number;
}

export interface Box {
  west: number;
  south: number;
  east: number;
  north: number;
}

/** `centre` is in the middle of the picture; a metre has `scale` pixels. */
export interface Camera {
  centre: Point;
  scale: number;
  width: number;
  height: number;
}

const LEAST_SCALE = 0.5;
const MOST_SCALE = 2000;
const MARGIN = 0.92;

function bounded(scale: number): number {
  return Math.min(MOST_SCALE, Math.max(LEAST_SCALE, scale));
}

export function toPicture(camera: Camera, hall: Point): Point {
  return {
    x: camera.width / 2 + (hall.x - camera.centre.x) * camera.scale,
    y: camera.height / 2 - (hall.y - camera.centre.y) * camera.scale,
  };
}

export function toHall(camera: Camera, picture: Point): Point {
  return {
    x: camera.centre.x + (picture.x - camera.width / 2) / camera.scale,
    y: camera.centre.y - (picture.y - camera.height / 2) / camera.scale,
  };
}

export function panned(camera: Camera, dx: number, dy: number): Camera {
  const centre = { x: camera.centre.x - dx / camera.scale, y: camera.centre.y + dy / camera.scale };
  return { ...camera, centre };
}

/** What is at `at` stays there. */
export function zoomed(camera: Camera, factor: number, at: Point): Camera {
  const before = toHall(camera, at);
  const next = { ...camera, scale: bounded(camera.scale * factor) };
  const after = toHall(next, at);
  const centre = { x: camera.centre.x + before.x - after.x, y: camera.centre.y + before.y - after.y };
  return { ...next, centre };
}

export function fitted(camera: Camera, box: Box): Camera {
  const width = Math.max(box.east - box.west, 0.1);
  const height = Math.max(box.north - box.south, 0.1);
  const scale = bounded(Math.min(camera.width / width, camera.height / height) * MARGIN);
  return { ...camera, centre: { x: (box.west + box.east) / 2, y: (box.south + box.north) / 2 }, scale };
}

export function withPoint(box: Box, { x, y }: Point): Box {
  return {
    west: Math.min(box.west, x), south: Math.min(box.south, y), east: Math.max(box.east, x), north: Math.max(box.north, y),
  };
}

/** The length of a scale bar of at most 140 pixels: 1, 2 or 5 times a power of ten, in metres. */
export function scaleBar(camera: Camera): number {
  const most = 140 / camera.scale;
  const power = 10 ** Math.floor(Math.log10(most));
  return (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1) * power;
}
