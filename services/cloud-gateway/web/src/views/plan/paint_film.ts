/** Draws what goes between the computers of a simulated fleet: messages on their way, and where nothing arrives. */
import { toPicture, type Camera, type Point } from '../../lib/map/camera';
import type { Colours } from '../../lib/map/paint';
import type { Scene } from './film';

/** More lines than that nobody tells apart. */
const MOST_CUTS = 120;
const SIZE = 7;

type Pen = CanvasRenderingContext2D;

/** `isCalm`: a message does not move; a line says who sends whom. */
export function paintFilm(pen: Pen, camera: Camera, colours: Colours, scene: Scene, at: Map<string, Point>, isCalm: boolean): void {
  const of = (id: string) => (at.has(id) ? toPicture(camera, at.get(id)!) : null);
  for (const [a, b] of scene.cuts.slice(0, MOST_CUTS)) {
    const [from, to] = [of(a), of(b)];
    if (from && to) paintCut(pen, from, to, colours);
  }
  for (const flight of scene.flights) {
    const [from, to] = [of(flight.from), of(flight.to)];
    if (from && to) paintMessage(pen, from, to, flight.phase === 'forward', isCalm ? 1 : flight.part, colours);
  }
}

function line(pen: Pen, from: Point, to: Point): void {
  pen.beginPath();
  pen.moveTo(from.x, from.y);
  pen.lineTo(to.x, to.y);
  pen.stroke();
}

/** Dashed, with a cross in its middle. */
function paintCut(pen: Pen, from: Point, to: Point, colours: Colours): void {
  const middle = { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
  pen.strokeStyle = colours.tones.urgent;
  pen.lineWidth = 1.5;
  pen.setLineDash([3, 6]);
  line(pen, from, to);
  pen.setLineDash([]);
  line(pen, { x: middle.x - 5, y: middle.y - 5 }, { x: middle.x + 5, y: middle.y + 5 });
  line(pen, { x: middle.x - 5, y: middle.y + 5 }, { x: middle.x + 5, y: middle.y - 5 });
}

/** A baton is a filled square on a thick line, any other message a hollow one on a thin line. */
function paintMessage(pen: Pen, from: Point, to: Point, isBaton: boolean, part: number, colours: Colours): void {
  const at = { x: from.x + part * (to.x - from.x), y: from.y + part * (to.y - from.y) };
  pen.strokeStyle = isBaton ? colours.focus : colours.muted;
  pen.lineWidth = isBaton ? 3 : 1;
  line(pen, from, at);
  const size = isBaton ? SIZE : SIZE - 2;
  // On a long way it is drawn beside the robot that it has reached, not below it.
  const far = Math.hypot(to.x - from.x, to.y - from.y);
  const back = Math.min(20, far / 2) * part;
  const x = at.x - (far === 0 ? 0 : (back * (to.x - from.x)) / far);
  const y = at.y - (far === 0 ? 0 : (back * (to.y - from.y)) / far);
  pen.fillStyle = isBaton ? colours.focus : colours.ground;
  pen.fillRect(x - size, y - size, 2 * size, 2 * size);
  pen.strokeRect(x - size, y - size, 2 * size, 2 * size);
}
