import { describe, expect, it } from 'vitest';
import { fitted, panned, scaleBar, toHall, toPicture, withPoint, zoomed, type Camera } from './camera';

const camera: Camera = { centre: { x: 3, y: 1 }, scale: 100, width: 800, height: 600 };

describe('the camera', () => {
  it('has north on top', () => {
    expect(toPicture(camera, { x: 3, y: 1 })).toEqual({ x: 400, y: 300 });
    expect(toPicture(camera, { x: 4, y: 2 })).toEqual({ x: 500, y: 200 });
    expect(toHall(camera, { x: 500, y: 200 })).toEqual({ x: 4, y: 2 });
  });

  it('moves the hall with the hand', () => {
    const after = panned(camera, 50, -20);
    expect(toPicture(after, { x: 3, y: 1 })).toEqual({ x: 450, y: 280 });
  });

  it('keeps what is under the pointer where it is while it zooms', () => {
    const at = { x: 100, y: 500 };
    const [before, after] = [toHall(camera, at), toHall(zoomed(camera, 2.5, at), at)];
    expect(after.x).toBeCloseTo(before.x);
    expect(after.y).toBeCloseTo(before.y);
  });

  it('has bounds', () => {
    let near = camera;
    for (let i = 0; i < 100; ++i) near = zoomed(near, 10, { x: 0, y: 0 });
    expect(near.scale).toBe(2000);
  });

  it('shows a whole box, also one without a size', () => {
    const box = withPoint({ west: 0, south: 0, east: 10, north: 2 }, { x: -2, y: 5 });
    const all = fitted(camera, box);
    for (const corner of [{ x: -2, y: 0 }, { x: 10, y: 5 }]) {
      const { x, y } = toPicture(all, corner);
      expect(x >= 0 && x <= 800 && y >= 0 && y <= 600).toBe(true);
    }
    expect(fitted(camera, { west: 1, south: 1, east: 1, north: 1 }).scale).toBe(2000);
  });

  it('has a round scale bar', () => {
    expect([0.7, 100, 130, 2000].map((scale) => scaleBar({ ...camera, scale }))).toEqual([200, 1, 1, 0.05]);
  });
});
