import { describe, expect, it } from 'vitest';
import { Trails } from './trails';

describe('a trail', () => {
  it('tells the course of a robot that has moved, and keeps it while it stands', () => {
    const trails = new Trails();
    trails.add('drone', { x: 0, y: 0 });
    expect(trails.course('drone')).toBeNull();
    trails.add('drone', { x: 0, y: 1 });
    expect(trails.add('drone', { x: 0.001, y: 1 })).toBe(false);
    expect(trails.course('drone')).toBeCloseTo(Math.PI / 2);
  });

  it('is bounded', () => {
    const trails = new Trails();
    for (let x = 0; x < 200; ++x) trails.add('drone', { x, y: 0 });
    expect(trails.trail('drone')).toHaveLength(60);
    expect(trails.trail('drone').at(-1)).toEqual({ x: 199, y: 0 });
  });

  it('ends with its robot', () => {
    const trails = new Trails();
    trails.add('drone', { x: 0, y: 0 });
    trails.keep(new Set(['ur3']));
    expect(trails.trail('drone')).toEqual([]);
  });
});
