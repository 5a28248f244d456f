"""Large motion of an elastic body in a box with slip walls, to round-off: the reference of 'manufactured'.

Material as mpm_stage's linear_elastic: Jaumann's rate of Cauchy stress = lambda tr(D) I + 2 G D, plane strain. In the
body's own coordinates X the displacement is sine along and cosine across each direction, so a Fourier collocation on the
mirrored (periodic) box of twice the width has spectral accuracy:
    rho_0 dv/dt = Div P,  P = J s F^-T,  ds/dt = W s - s W + lambda tr(D) I + 2 G D,  L = (grad_X v) F^-1.
Time goes by the classical Runge-Kutta method of order 4.
"""
import numpy as np


class TaylorGreenSolid:
    """Starts free of stress with velocity speed (sin pi x cos pi y, -cos pi x sin pi y) on [0, 1] x [0, 1] m."""

    def __init__(self, youngs_modulus, poisson_ratio, density, speed, modes=24):
        self.G = youngs_modulus / (2 * (1 + poisson_ratio))
        self.lam = 2 * self.G * poisson_ratio / (1 - 2 * poisson_ratio)
        self.density, self.n = density, 4 * modes
        x = np.arange(self.n) * (2.0 / self.n)
        self.X, self.Y = np.meshgrid(x, x, indexing="ij")
        k = np.fft.fftfreq(self.n, 1.0 / self.n) * np.pi
        keep = np.abs(np.fft.fftfreq(self.n, 1.0 / self.n)) < self.n / 3  # Orszag's rule against aliasing
        self.k, self.keep = k, keep
        self.speed = speed

    def gradient(self, f):
        hat = np.fft.fft2(f) * self.keep[:, None] * self.keep[None, :]
        return (np.real(np.fft.ifft2(1j * self.k[:, None] * hat)), np.real(np.fft.ifft2(1j * self.k[None, :] * hat)))

    def rate(self, q):
        ux, uy, vx, vy, sxx, syy, sxy = q
        (fxx, fxy), (fyx, fyy) = self.gradient(ux), self.gradient(uy)
        fxx, fyy = fxx + 1.0, fyy + 1.0
        J = fxx * fyy - fxy * fyx
        ixx, ixy, iyx, iyy = fyy / J, -fxy / J, -fyx / J, fxx / J
        (axx, axy), (ayx, ayy) = self.gradient(vx), self.gradient(vy)
        lxx, lxy = axx * ixx + axy * iyx, axx * ixy + axy * iyy
        lyx, lyy = ayx * ixx + ayy * iyx, ayx * ixy + ayy * iyy
        w, tr = 0.5 * (lxy - lyx), lxx + lyy
        pxx, pxy = J * (sxx * ixx + sxy * ixy), J * (sxx * iyx + sxy * iyy)
        pyx, pyy = J * (sxy * ixx + syy * ixy), J * (sxy * iyx + syy * iyy)
        return np.array([vx, vy,
                         (self.gradient(pxx)[0] + self.gradient(pxy)[1]) / self.density,
                         (self.gradient(pyx)[0] + self.gradient(pyy)[1]) / self.density,
                         2 * w * sxy + self.lam * tr + 2 * self.G * lxx,
                         -2 * w * sxy + self.lam * tr + 2 * self.G * lyy,
                         w * (syy - sxx) + self.G * (lxy + lyx)])

    def solve(self, end):
        """Returns the motion X -> x at time `end` for points (N, 2), and the largest principal stretch on the way."""
        zero = np.zeros_like(self.X)
        q = np.array([zero, zero, self.speed * np.sin(np.pi * self.X) * np.cos(np.pi * self.Y),
                      -self.speed * np.cos(np.pi * self.X) * np.sin(np.pi * self.Y), zero, zero, zero])
        wave = np.sqrt((self.lam + 2 * self.G) / self.density)
        steps = int(np.ceil(end * wave * self.n * 1.5)) + 1
        dt, stretch = end / steps, 1.0
        for i in range(steps):
            a = self.rate(q)
            b = self.rate(q + 0.5 * dt * a)
            c = self.rate(q + 0.5 * dt * b)
            d = self.rate(q + dt * c)
            q = q + dt / 6.0 * (a + 2 * b + 2 * c + d)
            if i % 20 == 0 or i + 1 == steps:
                stretch = max(stretch, self.largest_stretch(q))
        tail = [np.abs(np.fft.fft2(u)) for u in q[:2]]
        edge = [t[self.n // 3 - 3:self.n // 3].max() / t.max() for t in tail]
        if not max(edge) < 1e-5:
            raise ArithmeticError(f"the Fourier series has not converged: last modes {max(edge):.1e} of the largest")
        hats = [np.fft.fft2(u) / self.n**2 * self.keep[:, None] * self.keep[None, :] for u in q[:2]]

        def motion(points):
            ex = np.exp(1j * np.outer(points[:, 0], self.k))
            ey = np.exp(1j * np.outer(points[:, 1], self.k))
            return points + np.column_stack([np.real(np.sum((ex @ hat) * ey, axis=1)) for hat in hats])

        return motion, stretch

    def largest_stretch(self, q):
        (fxx, fxy), (fyx, fyy) = self.gradient(q[0]), self.gradient(q[1])
        F = np.stack([np.stack([fxx + 1, fxy], -1), np.stack([fyx, fyy + 1], -1)], -2)
        return float(np.linalg.svd(F, compute_uv=False).max())


if __name__ == "__main__":
    import time
    for m in (12, 24):
        s = time.time()
        motion, stretch = TaylorGreenSolid(1e6, 0.3, 1000.0, 3.5, m).solve(0.02)
        print(m, motion(np.array([[0.3, 0.2], [0.1, 0.45]])), stretch, time.time() - s)
