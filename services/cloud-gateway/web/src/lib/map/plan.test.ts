import { describe, expect, it } from 'vitest';
import { DEMONSTRATION, planOf } from './plan';

describe("the hall's walls", () => {
  it('are those that its people have drawn', () => {
    const box = { west: -1, south: 0, east: 30, north: 20 };
    expect(planOf({ places: [], poses: [], picture: box })).toEqual({ url: '/api/v1/places/picture', box });
  });

  it("are the demonstration's where nobody has drawn any", () => {
    expect(planOf({ places: [], poses: [] })).toBe(DEMONSTRATION);
  });
});
