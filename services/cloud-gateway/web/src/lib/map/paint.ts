/** Draws the hall on a canvas. No state: camera, things and colours in, strokes out. */
import { stateLooks, type Tone } from '../ui/shapes';
import type { RobotState } from '../fleet/robot_state';
import { scaleBar, toPicture, type Camera, type Point } from './camera';

export interface Colours {
  text: string;
  muted: string;
  ground: string;
  focus: string;
  shape: string;
  tones: Record<Tone, string>;
}

export interface Place extends Point {
  name: string;
}

export interface Mark extends Point {
  id: string;
  state: RobotState;
  course: number | null;
  /** Its label; asked for only if there is room for labels. */
  lines: () => string[];
  trail: Point[];
  isSelected: boolean;
}

const RADIUS = 11;
const CROSS = 5; // of a place: half of its length
const NOSE = 10;
const LINE = 17;
const MOST_LABELS = 80;
const FONT = '14px system-ui, sans-serif';
const paths = new Map<string, Path2D>();

export function coloursOf(element: Element): Colours {
  const style = getComputedStyle(element);
  const of = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return {
    text: of('text'), muted: of('text-muted'), ground: of('surface'), focus: of('focus'), shape: of('shape'),
    tones: {
      calm: of('shape'), stale: of('stale'), stopped: of('stopped'), critical: of('alarm-critical'),
      urgent: of('alarm-urgent'), warning: of('alarm-warning'),
    },
  };
}

/** `below`: draws what lies below the marks. */
export function paint(
  pen: CanvasRenderingContext2D, camera: Camera, places: Place[], marks: Mark[], colours: Colours,
  below?: (pen: CanvasRenderingContext2D, camera: Camera, colours: Colours) => void,
): void {
  pen.clearRect(0, 0, camera.width, camera.height);
  pen.font = FONT;
  pen.lineJoin = 'round';
  for (const place of places) paintPlace(pen, camera, place, colours);
  const shown = marks.filter((mark) => isInPicture(toPicture(camera, mark), camera));
  for (const mark of shown) paintTrail(pen, camera, mark, colours);
  below?.(pen, camera, colours);
  for (const mark of shown) paintMark(pen, toPicture(camera, mark), mark, colours);
  paintLabels(pen, camera, shown, places, colours);
  paintScale(pen, camera, colours);
}

function isInPicture(at: Point, camera: Camera): boolean {
  return at.x > -50 && at.y > -50 && at.x < camera.width + 50 && at.y < camera.height + 50;
}

function paintPlace(pen: CanvasRenderingContext2D, camera: Camera, place: Place, colours: Colours): void {
  const { x, y } = toPicture(camera, place);
  pen.strokeStyle = colours.muted;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x - CROSS, y);
  pen.lineTo(x + CROSS, y);
  pen.moveTo(x, y - CROSS);
  pen.lineTo(x, y + CROSS);
  pen.stroke();
}

function paintTrail(pen: CanvasRenderingContext2D, camera: Camera, mark: Mark, colours: Colours): void {
  if (mark.trail.length < 2) return;
  pen.strokeStyle = mark.isSelected ? colours.focus : colours.muted;
  pen.lineWidth = mark.isSelected ? 3 : 1.5;
  pen.beginPath();
  for (const point of mark.trail) {
    const { x, y } = toPicture(camera, point);
    pen.lineTo(x, y);
  }
  pen.stroke();
}

function pathOf(text: string): Path2D {
  const path = paths.get(text) ?? new Path2D(text);
  paths.set(text, path);
  return path;
}

function paintMark(pen: CanvasRenderingContext2D, at: Point, mark: Mark, colours: Colours): void {
  const look = stateLooks[mark.state];
  if (mark.course !== null) paintNose(pen, at, mark.course, colours);
  pen.save();
  pen.translate(at.x - RADIUS, at.y - RADIUS);
  pen.scale((2 * RADIUS) / 24, (2 * RADIUS) / 24);
  pen.fillStyle = look.isFilled ? colours.tones[look.tone] : colours.ground;
  pen.strokeStyle = look.tone === 'warning' ? colours.shape : colours.tones[look.tone];
  pen.lineWidth = 3;
  pen.fill(pathOf(look.path));
  pen.stroke(pathOf(look.path));
  pen.restore();
  if (mark.isSelected) paintRing(pen, at, colours);
}

function paintNose(pen: CanvasRenderingContext2D, at: Point, course: number, colours: Colours): void {
  pen.save();
  pen.translate(at.x, at.y);
  pen.rotate(-course);
  pen.fillStyle = colours.shape;
  pen.beginPath();
  pen.moveTo(RADIUS + NOSE, 0);
  pen.lineTo(RADIUS - 3, 8);
  pen.lineTo(RADIUS - 3, -8);
  pen.fill();
  pen.restore();
}

function paintRing(pen: CanvasRenderingContext2D, at: Point, colours: Colours): void {
  pen.strokeStyle = colours.focus;
  pen.lineWidth = 3;
  pen.beginPath();
  pen.arc(at.x, at.y, RADIUS + 7, 0, 2 * Math.PI);
  pen.stroke();
}

interface Rect {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** What labels have to do with: the picture's size, what lies there, and over what they lie only if need be. */
interface Room {
  width: number;
  height: number;
  taken: Rect[];
  avoided: Rect[];
}

/** Where nothing else is: right of its thing, left, above, below; if need be over what is avoided, or cut by the picture's end; nothing: the label is left out. */
export function roomFor(pen: CanvasRenderingContext2D, at: Point, lines: string[], away: number, room: Room): Rect | undefined {
  const width = Math.max(...lines.map((line) => pen.measureText(line).width));
  const height = lines.length * LINE;
  const places = [
    { x: at.x + away, y: at.y - height / 2 },
    { x: at.x - away - width, y: at.y - height / 2 },
    { x: at.x - width / 2, y: at.y - away - height },
    { x: at.x - width / 2, y: at.y + away },
  ];
  const free = places.map((place) => ({ ...place, width, height })).filter((rect) => !room.taken.some((other) => overlap(rect, other)));
  const whole = free.filter(({ x, y }) => x >= 0 && y >= 0 && x + width <= room.width && y + height <= room.height);
  return whole.find((rect) => !room.avoided.some((other) => overlap(rect, other))) ?? whole[0] ?? free[0];
}

/** The selected robot's first, places last. What finds no room is left out: the table has all robots. */
function paintLabels(pen: CanvasRenderingContext2D, camera: Camera, marks: Mark[], places: Place[], colours: Colours): void {
  const taken: Rect[] = marks.map((mark) => around(toPicture(camera, mark), RADIUS));
  const avoided = places.map((place) => around(toPicture(camera, place), CROSS));
  const label = (at: Point, lines: string[], away: number, colour: string) => {
    const rect = roomFor(pen, at, lines, away, { width: camera.width, height: camera.height, taken, avoided });
    if (rect === undefined) return;
    taken.push(rect);
    paintLabel(pen, rect, lines, colour, colours.ground);
  };
  const isCrowded = marks.length > MOST_LABELS;
  for (const mark of [...marks].sort((a, b) => Number(b.isSelected) - Number(a.isSelected))) {
    if (!isCrowded || mark.isSelected) label(toPicture(camera, mark), mark.lines(), RADIUS + 8, colours.text);
  }
  if (!isCrowded) for (const place of places) label(toPicture(camera, place), [place.name], 8, colours.muted);
}

function around(at: Point, radius: number): Rect {
  return { x: at.x - radius, y: at.y - radius, width: 2 * radius, height: 2 * radius };
}

function overlap(a: Rect, b: Rect): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

function paintLabel(pen: CanvasRenderingContext2D, rect: Rect, lines: string[], colour: string, halo: string): void {
  pen.lineWidth = 4;
  pen.strokeStyle = halo;
  pen.fillStyle = colour;
  lines.forEach((line, i) => {
    const y = rect.y + 13 + i * LINE;
    pen.strokeText(line, rect.x, y);
    pen.fillText(line, rect.x, y);
  });
}

function paintScale(pen: CanvasRenderingContext2D, camera: Camera, colours: Colours): void {
  const metres = scaleBar(camera);
  const [x, y, length] = [16, camera.height - 16, metres * camera.scale];
  pen.strokeStyle = colours.text;
  pen.fillStyle = colours.text;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(x, y - 6);
  pen.lineTo(x, y);
  pen.lineTo(x + length, y);
  pen.lineTo(x + length, y - 6);
  pen.stroke();
  pen.fillText(`${metres} m`, x + length + 6, y);
}
